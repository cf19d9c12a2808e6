!> Rows of a mechanism whose numbers are changed, solved from the position at hand by Newton's method, block by block:
!> never by a run of its own, which beside a change point could take the other branch.
module changed_rows
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use motion, only: motion_t, turned_t, new_motion, forget_links
   use points, only: row_t, find_row
   use blocks, only: largest_known, own_unknowns
   use block_state, only: unknown_t
   use block_solver, only: solve_block
   use block_matrix, only: solve_first, solve_again
   use block_equations, only: assemble_dense, right_hand_side
   use block_structure, only: structure_t
   use block_engine, only: block_engine_t, make_block_engine, put_mechanism, set_drive_values, get_motion, get_ratios, &
      slide_unit
   use convergence, only: convergence_t, is_solved, ended_inconsistent
   use rounded_numbers, only: directions, own_directions
   use link_motion, only: mark_links, missing_nothing, missing_rates, missing_all
   implicit none
   private
   public :: perturbed_t, at_hand_t, find_place, make_ready, put_changes, rows_with

   !> A spare set of numbers and a spare state, which serve for any change of a mechanism.
   type :: perturbed_t
      type(mechanism_t) :: m                     !< with changed numbers; its links are where the cards put them
      type(block_engine_t) :: engine
      type(motion_t) :: q                        !< found last
      logical :: is_ready = .false.              !< made for this mechanism
      logical :: fits = .true.                   !< the blocks of the engine serve for its numbers
      integer :: direction = -1                  !< its numbers are off by `roundings` in this one; -1: they are others
      real(wp) :: roundings = 0.0_wp, time_off = 0.0_wp   !< the instant is off by this part of it
      real(wp) :: length = 0.0_wp                !< then: see `put_off`
   end type perturbed_t

   !> The position at hand, and what the rows show that were found last from it.
   type :: at_hand_t
      type(unknown_t), allocatable :: start(:)   !< (0:unknowns) slides in the deck's unit
      logical :: only_driven = .false.           !< nothing is known of it but what drives alone move
      logical :: is_singular = .false.           !< it has no unique rates
      logical :: stays = .false.                 !< a search begins there, not a nudge away
      type(turned_t), allocatable :: turned(:)   !< (measures) angles of measures go on from there
      !> Of the rows: the largest Kantorovich ratio of a block, the change of its position over the distance of the
      !> next one; the largest change (rad, unit of the block) of an unknown; whether equations contradict.
      real(wp) :: ratio = 0.0_wp, change = 0.0_wp
      logical :: jams = .false.
      !> Redundant equations: the largest closure error (unit of the loop, rad), and what there is room for.
      real(wp) :: opened = 0.0_wp, room = huge(1.0_wp)
   end type at_hand_t

   !> Of a mechanism with so many links at most the changed ones are kept from instant to instant, each with its
   !> numbers; a larger one has one spare set of numbers, and needs less memory.
   integer, parameter :: most_links = 1000
   !> A search begins this far (rad, unit of the block) from the position at hand: there it would end at once, and show
   !> nothing of the residual that is left. On a dead point it begins where roundings may have moved it.
   real(wp), parameter :: nudge = sqrt(epsilon(1.0_wp))/1024.0_wp, singular_nudge = 16.0_wp*sqrt(epsilon(1.0_wp))
   !> Nothing is known of a change with a larger Kantorovich ratio: it is not of first order.
   real(wp), parameter :: largest_ratio = 0.5_wp
   !> At a dead point a position moves by the root of what changes (rad, unit of the block); a search that goes farther
   !> has found none, and ends anywhere.
   real(wp), parameter :: singular_change = 4096.0_wp*sqrt(epsilon(1.0_wp))

contains

   !> Finds the place of the motion `q`, which the engine `e` has found: from now on rows are solved from it.
   subroutine find_place(e, q, place)
      type(block_engine_t), intent(in) :: e
      type(motion_t), intent(in) :: q
      type(at_hand_t), intent(inout) :: place
      integer :: k

      place%only_driven = q%known < 0
      place%is_singular = q%known == 0
      if (allocated(q%turned)) place%turned = q%turned
      if (.not. allocated(place%start)) allocate (place%start(0:e%blocks%unknowns))
      place%start(:) = e%state%u
      do k = 1, ubound(place%start, 1)
         place%start(k)%value = place%start(k)%value*slide_unit(e, k)
      end do
   end subroutine find_place

   !> Makes number `i` of `list` ready for direction `k` of changes of `m`, whose engine is `e`, if it is not yet; its
   !> numbers are still others.
   subroutine make_ready(list, k, m, e, i)
      type(perturbed_t), allocatable, intent(inout) :: list(:)
      integer, intent(in) :: k
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      integer, intent(out) :: i
      type(structure_t) :: structure

      if (.not. allocated(list)) allocate (list(0:merge(directions + own_directions, 0, size(m%links) <= most_links)))
      i = merge(k, 0, k <= ubound(list, 1))
      associate (p => list(i))
         if (p%is_ready) return
         p%is_ready = .true.
         p%direction = -1
         p%m = m
         if (allocated(p%engine%blocks)) return
         structure%blocks = e%blocks
         structure%geometry = e%geometry
         call make_block_engine(p%engine, m, structure)
         p%q = new_motion(size(m%links))
         p%q%known = 2
      end associate
   end subroutine make_ready

   !> Gives the engine of `p` the numbers of p%m. `by_roundings`: they are off by roundings alone, and what cancels in
   !> the equations is left out: redundant equations stay so, and so do guides that are parallel.
   subroutine put_changes(p, by_roundings)
      type(perturbed_t), intent(inout) :: p
      logical, intent(in) :: by_roundings

      p%m%tolerance = 0.0_wp
      call put_mechanism(p%engine, p%m, p%fits)
      p%fits = p%fits .or. by_roundings
   end subroutine put_changes

   !> The `rows` (requests) of `p` at the time `t`, solved from `place`.
   subroutine rows_with(p, t, place, rows)
      type(perturbed_t), intent(inout) :: p
      real(wp), intent(in) :: t
      type(at_hand_t), intent(inout) :: place
      type(row_t), intent(inout) :: rows(:)
      type(block_engine_t), allocatable :: other
      integer :: i

      p%q%t = t
      if (p%fits) then
         call solve_needed(p%engine, place, p%q)
      else
         allocate (other)
         call make_block_engine(other, p%m)
         call solve_needed(other, place, p%q)
         if (.not. other%blocks%solvable .or. other%blocks%redundant /= p%engine%blocks%redundant) then
            place%jams = .true.
            p%q%link_known = spread(-1, 1, size(p%m%links))
         end if
      end if
      if (allocated(place%turned)) p%q%turned = place%turned
      do i = 1, size(rows)
         call find_row(p%m, p%q, p%m%requests(i), rows(i))
      end do
   end subroutine rows_with

   !> Solves the blocks of `e` in turn, to the limit of rounding, for the motion `q` at its time. What is known of it
   !> may differ from link to link.
   subroutine solve_needed(e, place, q)
      type(block_engine_t), intent(inout) :: e
      type(at_hand_t), intent(inout) :: place
      type(motion_t), intent(inout) :: q
      type(convergence_t) :: c
      integer :: missing(0:ubound(place%start, 1)), k, lack, worst
      logical :: finite

      place%ratio = 0.0_wp
      place%change = 0.0_wp
      place%jams = .false.
      place%opened = 0.0_wp
      if (.not. e%blocks%solvable) return
      e%state%u(:) = place%start
      do k = 1, ubound(e%state%u, 1)
         associate (x => e%state%u(k)%value)
            x = x/slide_unit(e, k)
            ! On a dead point the Jacobian has an inverse only where links that are in line turn apart.
            if (.not. place%stays) x = x + merge(singular_nudge*(-1)**k, nudge, place%is_singular)
         end associate
      end do
      call set_drive_values(e, q%t)
      missing = missing_nothing
      worst = missing_nothing
      do k = 1, size(e%needed)
         associate (i => e%needed(k), block => e%blocks%list(e%needed(k)))
            lack = missing_nothing
            if (worst > missing_nothing) lack = largest_known(e%blocks, i, missing)
            if (place%only_driven .and. .not. block%direct) lack = missing_all
            if (lack < missing_all) then
               c = convergence_t()
               call solve_block(e%blocks, e%geometry, i, .true., e%work, e%state, c)
               place%ratio = max(place%ratio, c%kantorovich_ratio)
               place%opened = max(place%opened, c%open%value/c%open%level)
               place%jams = place%jams .or. c%ended == ended_inconsistent .or. c%rates_open &
                  .or. place%opened > place%room
               if (c%singular) lack = missing_rates
               if (.not. is_solved(c) .or. c%rates_open) lack = missing_all
               if (block%shape%rows > block%shape%n .and. lack < missing_rates) call refine_rates(e, i)
               if (place%is_singular) then
                  if (c%change > singular_change) lack = missing_all
               else if (c%kantorovich_ratio > largest_ratio .and. .not. c%singular) then
                  lack = missing_all
               end if
            end if
            worst = max(worst, lack)
            if (lack > missing_nothing) missing(e%blocks%unknown(block%first:block%last)) = lack
         end associate
      end do
      ! That of a drive's own unknown counts too: full turns are no return.
      do k = 1, ubound(e%state%u, 1)
         place%change = max(place%change, abs(e%state%u(k)%value - place%start(k)%value/slide_unit(e, k)))
      end do
      call get_motion(e, q, finite)
      if (size(e%ratios) > 0) call get_ratios(e, [(missing(e%blocks%unknown(max(1, e%blocks%list(k)%first))) &
         > missing_nothing, k=1, size(e%blocks%list))], q)
      call forget_links(q)
      if (worst > missing_nothing) call mark_links(e%chain, missing, q)
   end subroutine solve_needed

   !> The rates of block `i` of `e` again, by iterative refinement. Orthogonal factors, of equations that are too many,
   !> leave errors by the largest of all rows; one pass leaves those of each row (Higham, Accuracy and Stability of
   !> Numerical Algorithms, 2002, ch. 20).
   subroutine refine_rates(e, i)
      type(block_engine_t), intent(inout) :: e
      integer, intent(in) :: i
      real(wp), allocatable :: jacobian(:, :)
      integer :: order, info

      associate (shape => e%blocks%list(i)%shape, w => e%work, &
         own => own_unknowns(e%blocks, i))
         call assemble_dense(e%blocks, e%geometry, i, e%state, w%a, w%r)
         jacobian = reshape(w%a(:shape%rows*shape%n), [shape%rows, shape%n])
         call solve_first(shape, w%a, w%pivots, w%work, w%r, info)
         if (info > 0) return
         do order = 1, 2
            call right_hand_side(e%blocks, e%geometry, i, order, e%state, w%r)
            w%r(:shape%rows) = w%r(:shape%rows) &
               - matmul(jacobian, merge(e%state%u(own)%rate, e%state%u(own)%acceleration, order == 1))
            call solve_again(shape, w%a, w%pivots, w%work, w%r)
            if (order == 1) e%state%u(own)%rate = e%state%u(own)%rate + w%r(:shape%n)
            if (order == 2) e%state%u(own)%acceleration = e%state%u(own)%acceleration + w%r(:shape%n)
         end do
      end associate
   end subroutine refine_rates
end module changed_rows
