!> A mechanism solved block by block, in the order of `blocks`: all that a block needs is known before it is solved.
!> Only blocks that a table needs are solved, and those that no drive moves only once. Structure (`blocks_t`, constant),
!> geometry, drive values, state and workspace are arguments; there is no other object.
module block_motion
   use kinds, only: wp
   use mechanism, only: mechanism_t, wanted_links, has_guide
   use scales, only: is_length
   use motion, only: motion_t, new_motion
   use drive_path, only: drive_path_t
   use convergence, only: solve_report_t
   use blocks, only: blocks_t, geometry_t, blocks_that_give, largest_known, own_unknowns
   use block_numbers, only: evaluate_geometry
   use block_state, only: state_t, unknown_t, set_drive_values
   use block_solver, only: workspace_t, solve_block, solve_explicit
   use link_motion, only: new_chain, assign_chain, move_links, flag_links, missing_nothing, missing_rates, missing_all
   implicit none
   private
   public :: select_solved_blocks, assign_geometry, assign_path, get_ratios, flag_singular_links, get_driven_links

contains

   !> Finds which blocks are solved for the requests of a mechanism, the drives of its ratios, and the chain of its
   !> links: those that the requests need come first. If the structure is not solvable, only tolerance and ratios are
   !> set.
   subroutine select_solved_blocks(m, b, x)
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(inout) :: b     !< of `m`; needed, moving, ratios, joint and is_found are set
      type(geometry_t), intent(inout) :: x   !< of `m`; tolerance and chain are set
      logical :: need(0:b%unknowns)
      integer :: i

      x%tolerance = m%tolerance
      b%ratios = [integer ::]
      if (any(m%requests%drive > 0)) b%ratios = pack([(i, i=1, size(m%drives))], &
         [(any(m%requests%drive == i), i=1, size(m%drives))])
      if (.not. b%solvable) return
      x%chain = new_chain(m, b, x, wanted_links(m))

      ! Needed are the blocks that move the links of the requests, and those whose redundant equations could contradict
      ! one another.
      need = .false.
      do i = 1, x%chain%wanted
         associate (h => x%chain%links(i))
            need([h%orientation, h%slide, h%root, h%root + min(h%root, 1)]) = .true.
         end associate
      end do
      b%needed = blocks_that_give(b, b%list%shape%rows > b%list%shape%n, need)
      ! With extremes the chain has all links that move with the needed unknowns: a run is a period only if all return.
      if (any(m%requests%extremes)) x%chain = new_chain(m, b, x, wanted_links(m) .or. need(b%tree%orientation))
      b%moving = pack(b%needed, moving_blocks(b, b%needed))

      b%is_found = wanted_links(m) .and. b%tree%orientation > 0
      do i = 1, size(m%links)
         if (b%is_found(i)) b%is_found(i) = .not. b%list(b%block_of(b%tree%orientation(i)))%explicit
      end do
      associate (revolute => .not. has_guide(m%pairs%kind))
         b%joint = reshape([m%points(pack(m%pairs%point_i, revolute))%link, &
            m%points(pack(m%pairs%point_j, revolute))%link], [2, count(revolute)], order=[2, 1])
      end associate
   end subroutine select_solved_blocks

   !> Gives a geometry and the path of its drives the numbers of a mechanism. If the numbers do not fit the structure,
   !> the geometry leaves out the unknowns and body vectors that the structure leaves out.
   subroutine assign_geometry(m, b, x, path, fits)
      type(mechanism_t), intent(in) :: m     !< with the links, points, pairs and drives of which the blocks were made
      type(blocks_t), intent(in) :: b        !< solvable
      type(geometry_t), intent(inout) :: x   !< a geometry of `b` with its chain; its cylinders stay
      type(drive_path_t), intent(inout) :: path   !< laws and units are set
      logical, intent(out) :: fits           !< the equations of these numbers have the structure `b`

      call evaluate_geometry(m, b, x, fits)
      x%tolerance = m%tolerance
      call assign_chain(m, b, x, x%chain)
      call assign_path(m, b, x, path)
   end subroutine assign_geometry

   !> Puts the laws of the drives of a mechanism, and the units of their values, into its path.
   subroutine assign_path(m, b, x, path)
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(in) :: b        !< of `m`, solvable
      type(geometry_t), intent(in) :: x      !< of `m`
      type(drive_path_t), intent(inout) :: path   !< laws and units are set; a leg stays
      integer :: i

      path%laws = m%drives
      path%unit = merge(1.0_wp/x%equations%length, 1.0_wp, is_length(m%drives))
      do i = 1, size(b%rows)
         associate (drive => b%rows(i)%drive)
            if (drive > 0) path%unit(drive) = path%unit(drive)/x%rows(i)%unit
         end associate
      end do
   end subroutine assign_path

   !> Solves for the motions by single drives at a position: in found%by(d) drive d, by which a ratio is requested, has
   !> the rate 1, and all other drives rest. `is_known` of a link is false if its rates are not unique, or out of range.
   subroutine get_ratios(b, x, path, is_lost, here, w, found)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(drive_path_t), intent(in) :: path   !< of the drives
      logical, intent(in) :: is_lost(:)      !< (blocks) it has no position, or no unique rates
      type(state_t), intent(in) :: here      !< the position
      type(workspace_t), intent(inout) :: w
      type(motion_t), intent(inout) :: found   !< of all links; found%by is set
      type(motion_t) :: unit
      type(state_t) :: s
      type(solve_report_t) :: c
      integer :: missing(0:b%unknowns), j, k
      logical :: has_rates, finite

      ! Callers have made sure that ratios are requested: a call that does nothing would cost a part of a step.
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
                  call solve_block(b, x, i, .false., w, s, c)
                  has_rates = .not. (c%singular .or. c%rates_inconsistent)
               end if
               if (.not. has_rates) call record_missing(b, i, missing_rates, missing)
            end associate
         end do

         call move_links(x%chain, x%chain%wanted, s, unit, finite)
         call flag_links(x%chain, missing, unit)
         associate (by => found%by(b%ratios(j)))
            by%velocity = unit%velocity
            by%acceleration = unit%acceleration
            by%is_known = unit%link_known == 2 .and. all(abs(unit%velocity) <= huge(1.0_wp) .and. &
               abs(unit%acceleration) <= huge(1.0_wp), dim=1)
         end associate
      end do
   end subroutine get_ratios

   !> Flags the links that have no velocities at a singular position: those that a singular block moves, itself or
   !> through their parents or other blocks. If all equations have one Jacobian without an inverse, only links that
   !> explicit blocks move have velocities.
   subroutine flag_singular_links(b, x, s, all_at_once, found)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(state_t), intent(in) :: s         !< with the position and its singular blocks
      logical, intent(in) :: all_at_once     !< all equations have one Jacobian
      type(motion_t), intent(inout) :: found   !< of all links; link_known and link_flag are set
      integer :: missing(0:b%unknowns), k

      missing = missing_nothing
      do k = 1, size(b%needed)
         associate (i => b%needed(k))
            call record_missing(b, i, merge(missing_rates, missing_nothing, s%is_singular(i) .or. &
               (all_at_once .and. .not. b%list(i)%explicit)), missing)
         end associate
      end do
      call flag_links(x%chain, missing, found)
   end subroutine flag_singular_links

   !> Finds the motion of the links that explicit blocks move, at a time without a position of all blocks. The motion of
   !> other links is flagged as missing. If the structure is not solvable, nothing is found.
   subroutine get_driven_links(b, x, path, t, w, s, found)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(drive_path_t), intent(in) :: path   !< of the drives
      real(wp), intent(in) :: t              !< the parameter of the path, in the deck's unit of time
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s      !< its drives and the unknowns of explicit blocks are set
      type(motion_t), intent(inout) :: found   !< of all links; link_known and link_flag are set, its own flag stays
      type(state_t) :: driven                           ! missing unknowns are 0 in it
      integer :: missing(0:b%unknowns), k, i
      logical :: finite

      if (.not. b%solvable) return
      call set_drive_values(path, t, s)
      missing = missing_nothing
      do k = 1, size(b%needed)
         i = b%needed(k)
         call record_missing(b, i, merge(missing_nothing, missing_all, b%list(i)%explicit), missing)
         if (.not. b%list(i)%explicit) cycle
         if (missing(b%unknown(b%list(i)%first)) == missing_nothing) call solve_explicit(b, x, i, s)
      end do
      driven = s
      do k = 1, b%unknowns
         if (missing(k) > missing_nothing) driven%u(k) = unknown_t()
      end do
      call flag_links(x%chain, missing, found)
      call move_links(x%chain, x%chain%wanted, driven, found, finite)
      if (size(b%ratios) > 0) call get_ratios(b, x, path, .not. b%list%explicit, s, w, found)
   end subroutine get_driven_links

   !> Records the missing part of the unknowns of a block: the worse of the part that its own equations leave out and
   !> the worst part missing of the blocks on which it builds.
   subroutine record_missing(b, i, own, missing)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i               !< the number of the block
      integer, intent(in) :: own             !< by its own equations: missing_nothing, ...
      integer, intent(inout) :: missing(0:)  !< (0:unknowns) missing_nothing, ...; before, 0 for the block's own

      missing(own_unknowns(b, i)) = max(own, largest_known(b, i, missing))
   end subroutine record_missing

   !> Tells of each block of a list (blocks of the list) whether a drive moves it, directly or through blocks on which
   !> it builds.
   pure function moving_blocks(b, list) result(moving)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: list(:)   !< (any number) numbers of blocks with all on which they build, in solving order
      logical :: moving(size(list))
      integer :: moves(0:b%unknowns), k

      moves = 0
      do k = 1, size(list)
         associate (block => b%list(list(k)))
            moving(k) = any(b%rows(block%first_row:block%last_row)%drive > 0) .or. largest_known(b, list(k), moves) > 0
            moves(b%unknown(block%first:block%last)) = merge(1, 0, moving(k))
         end associate
      end do
   end function moving_blocks
end module block_motion
