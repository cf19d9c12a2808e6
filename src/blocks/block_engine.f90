!> A mechanism solved block by block, in the order of `blocks`: all that a block needs is known before it is solved.
!> Only blocks that a table needs are solved, and those that no drive moves only once.
module block_engine
   use kinds, only: wp
   use mechanism, only: mechanism_t, wanted_links, has_guide
   use scales, only: is_length
   use cylinders, only: cylinder_t, cylinders_of
   use motion, only: motion_t, new_motion
   use structure, only: structure_t, make_structure
   use initial_estimate, only: estimated_values
   use drive_path, only: drive_path_t, drive_at
   use convergence, only: convergence_t, nothing_gathered, is_solved, gather, ended_singular
   use bilinear, only: kept_start_t
   use predictor, only: history_t, remember, predict, largest_change, uncertain_part
   use blocks, only: blocks_t, geometry_t, moving_blocks, blocks_that_give, iterated_unknowns, largest_known, &
      own_unknowns
   use block_numbers, only: put_numbers
   use block_state, only: state_t, unknown_t, new_state, set_direction, set_values, add_turns
   use block_solver, only: workspace_t, new_workspace, solve_block, solve_direct
   use singular_place, only: settle
   use block_rank, only: jacobian_of, relative_sign
   use link_motion, only: new_chain, put_chain, move_links, mark_links, missing_nothing, missing_rates, &
      missing_all
   implicit none
   private
   public :: block_engine_t, engine_state_t, followed_t, choice_t
   public :: make_block_engine, take_requests, renew_block_engine, put_geometry, put_path, solve_blocks, solve_each, &
      separation_of, set_drive_values, accept, get_motion, get_ratios, mark_singular_links, get_driven_links, &
      followed_state, slide_unit

   !> What the factors of a block's Jacobian say.
   type :: jacobian_t
      integer :: sign_of = 1                            !< of the determinant
      real(wp) :: pivot = 1.0_wp                        !< the least; 1 of a direct block
      real(wp) :: inverse = 0.0_wp                      !< |J^-1|
   end type jacobian_t

   !> How the position of a block at the first instant was chosen.
   type :: choice_t
      real(wp) :: separation = 0.0_wp                   !< of other positions, at least: see `separation_of`
      logical :: is_close = .false.                     !< another one is about as near
      logical :: is_incomplete = .false.                !< a nearer one may not have been found
   end type choice_t

   !> What is followed: the last motions accepted, and what the Jacobians of the latest say.
   type :: followed_t
      type(history_t) :: history                        !< of the motion that is followed
      type(jacobian_t), allocatable :: followed(:)      !< (blocks) there
      real(wp), allocatable :: jacobian(:)              !< there, of the block with too many rows: (rows*n)
   end type followed_t

   !> All that depends on earlier instants: what is followed, and the motion found last. A checkpoint is an assignment:
   !> of this type, or of `followed_t` where the motion found last is to stay.
   type, extends(followed_t) :: engine_state_t
      real(wp) :: t = 0.0_wp, change = 0.0_wp           !< of the motion found last; of a predicted value, at most
      type(state_t) :: state                            !< its values
      type(jacobian_t), allocatable :: found(:)         !< (blocks)
      logical, allocatable :: is_singular(:), crossed(:) !< (blocks) without velocities; with a new sign of determinant
   end type engine_state_t

   !> Structure and geometry, the path of the drives, and how the first position is chosen do not change with the
   !> instant; `work` is scratch.
   type, extends(engine_state_t) :: block_engine_t
      type(blocks_t), allocatable :: blocks
      type(geometry_t), allocatable :: geometry
      type(drive_path_t) :: path                        !< of its drives
      type(cylinder_t), allocatable :: cylinders(:)     !< its cylinders
      real(wp), allocatable :: estimated(:)             !< (0:unknowns) from the deck's positions
      real(wp), allocatable :: estimate(:, :)           !< (3, links) places from the chain's origin, angles of the deck
      type(choice_t), allocatable :: choice(:)          !< (blocks) of their positions at the first instant
      type(kept_start_t), allocatable :: starts(:)      !< (blocks) near which the paths to all positions begin
      type(workspace_t) :: work
   end type block_engine_t

contains

   !> Makes the engine ready for the first instant of `m`. `structure`: that of `m`, whose blocks and geometry the
   !> engine takes over; without it the engine makes one.
   subroutine make_block_engine(e, m, structure)
      type(block_engine_t), intent(out) :: e
      type(mechanism_t), intent(in) :: m
      type(structure_t), intent(inout), optional :: structure
      type(structure_t) :: own

      if (present(structure)) then
         call move_alloc(structure%blocks, e%blocks)
         call move_alloc(structure%geometry, e%geometry)
      else
         call make_structure(m, own)
         call move_alloc(own%blocks, e%blocks)
         call move_alloc(own%geometry, e%geometry)
      end if
      call take_requests(m, e%blocks, e%geometry)
      e%cylinders = cylinders_of(m, .false.)
      if (.not. e%blocks%solvable) return
      allocate (e%estimate(3, size(m%links)), e%estimated(0:e%blocks%unknowns))
      call put_estimate(e, m)
      call put_path(m, e%blocks, e%geometry, e%path)
      call begin_state(e, m)
   end subroutine make_block_engine

   !> Finds which of the blocks `b` of `m`, with the geometry `x`, are solved for its requests, and the chain of the
   !> links that these ask for.
   subroutine take_requests(m, b, x)
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(inout) :: b
      type(geometry_t), intent(inout) :: x
      logical :: need(0:b%unknowns)
      integer :: i

      x%tolerance = m%tolerance
      b%ratios = [integer ::]
      if (any(m%requests%drive > 0)) b%ratios = pack([(i, i=1, size(m%drives))], &
         [(any(m%requests%drive == i), i=1, size(m%drives))])
      if (.not. b%solvable) return
      x%chain = new_chain(m, b, x, wanted_links(m))
      ! Needed is what moves the links asked for, and where redundant equations could contradict one another.
      need = .false.
      do i = 1, x%chain%wanted
         associate (h => x%chain%links(i))
            need([h%orientation, h%slide, h%root, h%root + min(h%root, 1)]) = .true.
         end associate
      end do
      b%needed = blocks_that_give(b, b%list%shape%rows > b%list%shape%n, need)
      b%moving = pack(b%needed, moving_blocks(b, b%needed))
      b%is_found = wanted_links(m) .and. b%tree%orientation > 0
      do i = 1, size(m%links)
         if (b%is_found(i)) b%is_found(i) = .not. b%list(b%block_of(b%tree%orientation(i)))%direct
      end do
      associate (revolute => .not. has_guide(m%pairs%kind))
         b%joint = reshape([m%points(pack(m%pairs%point_i, revolute))%link, &
            m%points(pack(m%pairs%point_j, revolute))%link], [2, count(revolute)], order=[2, 1])
      end associate
   end subroutine take_requests

   !> Gives the geometry `x` and the `path` the numbers of `m`, a mechanism with the links, points, pairs and drives of
   !> that of which the blocks `b` were made. `fits`: see `put_numbers`.
   subroutine put_geometry(m, b, x, path, fits)
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(inout) :: x
      type(drive_path_t), intent(inout) :: path
      logical, intent(out) :: fits

      call put_numbers(m, b, x, fits)
      x%tolerance = m%tolerance
      call put_chain(m, b, x, x%chain)
      call put_path(m, b, x, path)
   end subroutine put_geometry

   !> Makes `e`, the engine of a variant of `m`, ready for the first instant of `m`, as `make_block_engine` makes it,
   !> with the blocks and the memory that it has. `is_done`: they fit; otherwise `e` is of no use.
   subroutine renew_block_engine(e, m, is_done)
      type(block_engine_t), intent(inout) :: e
      type(mechanism_t), intent(in) :: m
      logical, intent(out) :: is_done

      is_done = e%blocks%solvable
      if (is_done) call put_geometry(m, e%blocks, e%geometry, e%path, is_done)
      if (.not. is_done) return
      if (size(e%cylinders) > 0) e%cylinders = cylinders_of(m, .false.)
      call put_estimate(e, m)
      call begin_state(e, m)
   end subroutine renew_block_engine

   !> Gives `e` the state in which nothing is solved for `m` yet.
   subroutine begin_state(e, m)
      type(block_engine_t), intent(inout) :: e
      type(mechanism_t), intent(in) :: m

      e%engine_state_t = engine_state_t()
      e%state = new_state(e%blocks, size(m%drives))
      e%history = history_t(predicted=iterated_unknowns(e%blocks, e%blocks%moving), order=m%predictor)
      allocate (e%history%past(0:e%blocks%unknowns))
      associate (n => size(e%blocks%list))
         allocate (e%found(n), e%followed(n))
         allocate (e%crossed(n), e%is_singular(n), source=.false.)
         if (.not. allocated(e%choice)) allocate (e%choice(n), e%starts(n))
      end associate
      e%choice = choice_t()
      if (.not. allocated(e%work%a)) e%work = new_workspace(e%blocks)
   end subroutine begin_state

   !> The estimate that `m` gives.
   subroutine put_estimate(e, m)
      type(block_engine_t), intent(inout) :: e
      type(mechanism_t), intent(in) :: m
      integer :: i

      do i = 1, size(m%links)
         e%estimate(:, i) = m%links(i)%position - [e%geometry%chain%origin, 0.0_wp]
      end do
      ! As a section: a function's result would bring its own lower bound.
      e%estimated(:) = estimated_values(m, e%blocks, e%geometry)
   end subroutine put_estimate

   !> Puts the laws of the drives of `m`, and the units of their values, into its `path`.
   subroutine put_path(m, b, x, path)
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(drive_path_t), intent(inout) :: path
      integer :: i

      path%laws = m%drives
      path%unit = merge(1.0_wp/x%equations%length, 1.0_wp, is_length(m%drives))
      do i = 1, size(b%rows)
         associate (drive => b%rows(i)%drive)
            if (drive > 0) path%unit(drive) = path%unit(drive)/x%rows(i)%unit
         end associate
      end do
   end subroutine put_path

   !> Solves for the motion at `t`, from the one accepted last (`follows`) or from the deck's estimate. `c`: how that
   !> ended in the worst block, with the largest change of a predicted value.
   subroutine solve_blocks(e, t, follows, c)
      type(block_engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      logical, intent(in) :: follows
      type(convergence_t), intent(inout) :: c
      integer :: k

      if (.not. e%blocks%solvable) then
         c = convergence_t(ended=ended_singular)
         return
      end if
      e%t = t
      call set_drive_values(e%path, t, e%state)
      c = nothing_gathered
      if (follows) then
         call predict(e%history, t, e%state%u, e%change)
         c%keeps_signs = e%change <= largest_change
         if (.not. c%keeps_signs) e%crossed = .false.
         if (c%keeps_signs) call solve_each(e, e%blocks%moving, follows, c)
      else
         ! Whole turns that a drive asks for close nothing, and would have to be travelled.
         e%state%u%value = e%estimated
         do k = 1, size(e%blocks%needed)
            associate (i => e%blocks%needed(k))
               if (.not. e%blocks%list(i)%direct) call add_turns(e%blocks, e%geometry, i, e%state)
            end associate
         end do
         e%estimated(:) = e%state%u%value
         e%choice = choice_t()
         call solve_each(e, e%blocks%needed, follows, c)
      end if
   end subroutine solve_blocks

   !> How far the angles of another position of block `i` are from those of the position in `s` that `c` is of: one of
   !> them by so many rad, at least, with the Jacobian J and its Lipschitz constant L by 2/(|J^-1| L). Of more than two
   !> unknowns |J^-1| may be estimated, too small by a part of their number; the slides make L larger.
   pure real(wp) function separation_of(b, x, i, s, c) result(separation)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i
      type(state_t), intent(in) :: s
      type(convergence_t), intent(in) :: c
      real(wp) :: bound
      integer :: m, k

      separation = 0.0_wp
      if (.not. is_solved(c) .or. c%singular) return
      bound = 1.0_wp
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         do k = b%loops(m)%first_slide, b%loops(m)%last_slide
            bound = max(bound, 1.0_wp + 0.5_wp*abs(s%u(b%slides(k)%unknown)%value))
         end do
      end do
      bound = bound*x%blocks(i)%lipschitz*c%inverse
      if (b%list(i)%shape%n > 2) bound = bound*real(b%list(i)%shape%n, wp)
      separation = 2.0_wp/max(bound, tiny(bound))
   end function separation_of

   !> Finds value, rate and acceleration of the drives at the parameter `t` of their `path`.
   pure subroutine set_drive_values(path, t, s)
      type(drive_path_t), intent(in) :: path
      real(wp), intent(in) :: t
      type(state_t), intent(inout) :: s
      real(wp) :: f(3)
      integer :: i

      do i = 1, size(path%laws)
         f = drive_at(path, i, t)
         s%drive_value(0:2, i) = path%unit(i)*f
      end do
   end subroutine set_drive_values

   !> Solves the blocks of `list` in turn, up to the first without a position; arguments as in `solve_blocks`.
   subroutine solve_each(e, list, follows, c)
      type(block_engine_t), intent(inout) :: e
      integer, intent(in), contiguous :: list(:)
      logical, intent(in) :: follows
      type(convergence_t), intent(inout) :: c
      type(convergence_t) :: one
      integer :: k, i

      do k = 1, size(list)
         i = list(k)
         associate (block => e%blocks%list(i))
            call solve_block(e%blocks, e%geometry, i, .true., e%work, e%state, one)
            if (block%direct) cycle
            if (follows) then
               c%change = max(c%change, one%change)
               if (block%shape%rows > block%shape%n .and. is_solved(one)) &
                  one%determinant = e%followed(i)%sign_of &
                  *relative_sign(e%blocks, e%geometry, i, e%jacobian, e%state)
            else
               e%choice(i)%separation = separation_of(e%blocks, e%geometry, i, e%state, one)
            end if
            call gather(one, c)
            if (.not. is_solved(one)) return
            e%is_singular(i) = one%singular
            ! At a change point itself the sign is that of rounding.
            e%crossed(i) = follows .and. .not. one%singular .and. one%determinant /= e%followed(i)%sign_of
            if (one%singular) call settle(e%blocks, e%geometry, i, e%state)
            if (one%singular) cycle
            if (e%crossed(i)) c%keeps_signs = .false.
            c%kantorovich_ratio = max(c%kantorovich_ratio, one%kantorovich_ratio)
            if (e%state%excursion > 0.0_wp) c%growth = max(c%growth, &
               e%geometry%blocks(i)%lipschitz*max(one%inverse, e%followed(i)%inverse)**2)
            e%found(i) = jacobian_t(one%determinant, one%min_pivot, one%inverse)
         end associate
      end do
   end subroutine solve_each

   !> The motion found last becomes the one that is followed.
   subroutine accept(e)
      type(block_engine_t), intent(inout) :: e
      real(wp) :: uncertain
      integer :: k

      if (e%history%filled == 0) e%followed = e%found
      uncertain = 0.0_wp
      do k = 1, size(e%blocks%moving)
         e%followed(e%blocks%moving(k)) = e%found(e%blocks%moving(k))
         uncertain = max(uncertain, &
            uncertain_part(e%blocks, e%geometry, e%blocks%moving(k), e%found(e%blocks%moving(k))%pivot, e%state))
      end do
      call remember(e%history, e%t, e%state%u, uncertain)
      if (e%blocks%redundant > 0) e%jacobian = jacobian_of(e%blocks, e%geometry, 1, e%state)
   end subroutine accept

   !> The motion found last of the links that are asked for, in the deck's units; `finite`: all of it is known to be in
   !> range.
   subroutine get_motion(e, found, finite)
      type(block_engine_t), intent(in) :: e
      type(motion_t), intent(inout) :: found
      logical, intent(out) :: finite

      call move_links(e%geometry%chain, e%state, e%geometry%equations%length, found, finite)
   end subroutine get_motion

   !> Finds the motions found%by in which one of the drives by which ratios are asked for has the rate 1 and the others
   !> rest, at the position `here`: as the motion itself, with other values of drives.
   subroutine get_ratios(b, x, path, is_lost, here, w, found)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(drive_path_t), intent(in) :: path
      logical, intent(in) :: is_lost(:)      !< (blocks) without a position, or without unique rates
      type(state_t), intent(in) :: here
      type(workspace_t), intent(inout) :: w
      type(motion_t), intent(inout) :: found
      type(motion_t) :: unit
      type(state_t) :: s
      type(convergence_t) :: c
      integer :: missing(0:b%unknowns), j, k
      logical :: has_rates, finite

      ! Whoever calls has asked whether there are any: a call that does nothing is a part of a step.
      if (.not. allocated(found%by)) allocate (found%by(size(path%laws)))
      unit = new_motion(size(found%position, 2))
      do j = 1, size(b%ratios)
         s = here
         s%drive_value(1:, :) = 0.0_wp
         s%drive_value(1, b%ratios(j)) = path%unit(b%ratios(j))
         missing = missing_nothing
         do k = 1, size(b%needed)
            associate (i => b%needed(k))
               has_rates = .not. is_lost(i)
               if (has_rates) has_rates = largest_known(b, i, missing) == missing_nothing
               if (has_rates) then
                  c = convergence_t()
                  call solve_block(b, x, i, .false., w, s, c)
                  has_rates = .not. (c%singular .or. c%rates_open)
               end if
               if (.not. has_rates) call note_block(b, i, missing_rates, missing)
            end associate
         end do
         call move_links(x%chain, s, x%equations%length, unit, finite)
         call mark_links(x%chain, missing, unit)
         associate (by => found%by(b%ratios(j)))
            by%velocity = unit%velocity
            by%acceleration = unit%acceleration
            by%is_known = unit%link_known == 2 .and. all(abs(unit%velocity) <= huge(1.0_wp) .and. &
               abs(unit%acceleration) <= huge(1.0_wp), dim=1)
         end associate
      end do
   end subroutine get_ratios

   !> Tells which links have velocities in the motion `found` last, where not all have. `all_at_once`: with one Jacobian
   !> for all equations, which has no inverse; then those alone that drives move.
   subroutine mark_singular_links(e, found, all_at_once)
      type(block_engine_t), intent(in) :: e
      type(motion_t), intent(inout) :: found
      logical, intent(in) :: all_at_once
      integer :: missing(0:e%blocks%unknowns), k

      missing = missing_nothing
      do k = 1, size(e%blocks%needed)
         associate (i => e%blocks%needed(k))
            call note_block(e%blocks, i, merge(missing_rates, missing_nothing, e%is_singular(i) .or. &
               (all_at_once .and. .not. e%blocks%list(i)%direct)), missing)
         end associate
      end do
      call mark_links(e%geometry%chain, missing, found)
   end subroutine mark_singular_links

   !> Finds what is certain at `t`, where there is no position: the motion of the links that drives alone move. `found`
   !> has its mark already.
   subroutine get_driven_links(e, t, found)
      type(block_engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      type(motion_t), intent(inout) :: found
      type(state_t) :: s                                !< with numbers for what is lost, too
      integer :: missing(0:e%blocks%unknowns), k, i
      logical :: finite

      if (.not. e%blocks%solvable) return
      call set_drive_values(e%path, t, e%state)
      missing = missing_nothing
      do k = 1, size(e%blocks%needed)
         i = e%blocks%needed(k)
         call note_block(e%blocks, i, merge(missing_nothing, missing_all, e%blocks%list(i)%direct), missing)
         if (.not. e%blocks%list(i)%direct) cycle
         if (missing(e%blocks%unknown(e%blocks%list(i)%first)) == missing_nothing) &
            call solve_direct(e%blocks, e%geometry, i, e%state)
      end do
      s = e%state
      do k = 1, e%blocks%unknowns
         if (missing(k) > missing_nothing) s%u(k) = unknown_t()
      end do
      call mark_links(e%geometry%chain, missing, found)
      call move_links(e%geometry%chain, s, e%geometry%equations%length, found, finite)
      if (size(e%blocks%ratios) > 0) call get_ratios(e%blocks, e%geometry, e%path, &
         .not. e%blocks%list%direct, e%state, e%work, found)
   end subroutine get_driven_links

   !> Finds the state `s` of the motion that is followed; at the first instant that of the deck's estimate, but for what
   !> drives alone give.
   subroutine followed_state(e, s)
      type(block_engine_t), intent(in) :: e
      type(state_t), intent(out) :: s
      integer :: k, i

      s = e%state
      if (e%history%filled > 0) then
         call set_drive_values(e%path, e%history%t(0), s)
         do k = 1, size(e%history%predicted)
            i = e%history%predicted(k)
            associate (past => e%history%past(i))
               s%u(i)%value = past%value
               s%u(i)%rate = past%rate(0)
               s%u(i)%acceleration = past%acceleration(0)
            end associate
            call set_direction(e%blocks, i, s)
         end do
      end if
      do k = 1, size(e%blocks%needed)
         i = e%blocks%needed(k)
         if (e%blocks%list(i)%direct) then
            call solve_direct(e%blocks, e%geometry, i, s)
         else if (e%history%filled == 0) then
            call set_values(e%blocks, i, e%estimated(own_unknowns(e%blocks, i)), s)
         end if
      end do
   end subroutine followed_state

   !> Notes what is missing of the unknowns of block `i`: what its `own` equations leave out, or what it builds on
   !> lacks.
   subroutine note_block(b, i, own, missing)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, own
      integer, intent(inout) :: missing(0:)

      missing(own_unknowns(b, i)) = max(own, largest_known(b, i, missing))
   end subroutine note_block

   !> The unit of unknown number `k` in the deck's, if it is a slide; 1 of an angle.
   pure real(wp) function slide_unit(b, x, k) result(unit)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: k

      unit = x%unit(k)
      if (k > b%orientations) unit = unit*x%equations%length
   end function slide_unit
end module block_engine
