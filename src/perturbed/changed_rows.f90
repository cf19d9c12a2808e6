!> Rows of a mechanism whose numbers are changed, solved from the position at hand by Newton's method, block by block:
!> never by a run of its own, which beside a change point could take the other branch.
module changed_rows
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use motion, only: motion_t, new_motion
   use points, only: row_t, find_row
   use blocks, only: largest_known
   use block_state, only: unknown_t
   use block_solver, only: solve_block
   use block_matrix, only: solve_first, solve_again
   use block_equations, only: assemble_block, right_hand_side
   use block_engine, only: block_engine_t, make_block_engine, put_mechanism, set_drive_values, get_motion, &
      slide_units
   use convergence, only: convergence_t, is_solved, ended_inconsistent
   use rounded_numbers, only: put_loops_off
   use link_motion, only: mark_links, missing_nothing, missing_rates, missing_all
   implicit none
   private
   public :: perturbed_t, begin_from, rows_with

   !> One spare set of numbers and one spare state, which serve for all changes of a mechanism.
   type :: perturbed_t
      type(mechanism_t) :: m                     !< with changed numbers; its links are where the cards put them
      type(block_engine_t) :: engine
      logical :: is_ready = .false.
      type(unknown_t), allocatable :: start(:)   !< (0:unknowns) the position at hand, slides in the deck's unit
      logical :: only_driven = .false.           !< nothing is known of it but what drives alone move
      logical :: is_singular = .false.           !< it has no unique rates
      logical :: stays = .false.                 !< a search begins there, not a nudge away
      integer :: direction = 0                   !< vectors of its loops are off by a rounding in it; 0: they are not
      !> Of the rows found last: the largest Kantorovich ratio of a block, the change of its position over the distance
      !> of the next one; the largest change (rad, unit of the block) of an unknown; whether equations contradict.
      real(wp) :: ratio = 0.0_wp, change = 0.0_wp
      logical :: jams = .false.
   end type perturbed_t

   !> A search begins this far (rad, unit of the block) from the position at hand: there it would end at once, and show
   !> nothing of the residual that is left. On a dead point it begins where roundings may have moved it.
   real(wp), parameter :: nudge = sqrt(epsilon(1.0_wp))/1024.0_wp, singular_nudge = 16.0_wp*sqrt(epsilon(1.0_wp))
   !> Nothing is known of a change with a larger Kantorovich ratio: it is not of first order.
   real(wp), parameter :: largest_ratio = 0.5_wp
   !> At a dead point a position moves by the root of what changes (rad, unit of the block); a search that goes farther
   !> has found none, and ends anywhere.
   real(wp), parameter :: singular_change = 4096.0_wp*sqrt(epsilon(1.0_wp))

contains

   !> From now on rows are solved from the motion `q` of `m`, which the engine `e` has found.
   subroutine begin_from(p, m, e, q)
      type(perturbed_t), intent(inout) :: p
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      type(motion_t), intent(in) :: q

      if (.not. p%is_ready) then
         p%m = m
         call make_block_engine(p%engine, m)
         allocate (p%start(0:p%engine%blocks%unknowns))
         p%is_ready = .true.
      end if
      p%only_driven = q%known < 0
      p%is_singular = q%known == 0
      p%start(:) = e%state%u
      p%start%value = p%start%value*slide_units(e)
   end subroutine begin_from

   !> The `rows` (requests) of p%m at the time `t`. `by_roundings`: its numbers are off by roundings alone, and what
   !> cancels in the equations of `m` is zero: redundant equations stay so, and so do guides that are parallel.
   subroutine rows_with(p, t, by_roundings, rows)
      type(perturbed_t), intent(inout) :: p
      real(wp), intent(in) :: t
      logical, intent(in) :: by_roundings
      type(row_t), intent(inout) :: rows(:)
      type(block_engine_t), allocatable :: other
      type(motion_t) :: q
      logical :: fits
      integer :: i

      q = new_motion(size(p%m%links))
      q%t = t
      q%known = 2
      call put_mechanism(p%engine, p%m, fits)
      if (fits .or. by_roundings) then
         call solve_needed(p, p%engine, q)
      else
         allocate (other)
         call make_block_engine(other, p%m)
         call solve_needed(p, other, q)
         if (.not. other%blocks%solvable .or. other%blocks%redundant /= p%engine%blocks%redundant) then
            p%jams = .true.
            q%link_known = spread(-1, 1, size(p%m%links))
         end if
      end if
      do i = 1, size(rows)
         call find_row(p%m, q, p%m%requests(i), rows(i))
      end do
   end subroutine rows_with

   !> Solves the blocks of `e` in turn, to the limit of rounding, for the motion `q` at its time. What is known of it
   !> may differ from link to link.
   subroutine solve_needed(p, e, q)
      type(perturbed_t), intent(inout) :: p
      type(block_engine_t), intent(inout) :: e
      type(motion_t), intent(inout) :: q
      type(convergence_t) :: c
      integer :: missing(0:ubound(p%start, 1)), k, lack
      logical :: finite

      p%ratio = 0.0_wp
      p%change = 0.0_wp
      p%jams = .false.
      if (.not. e%blocks%solvable) return
      e%state%u(:) = p%start
      e%state%u%value = p%start%value/slide_units(e)
      do k = 1, merge(0, ubound(e%state%u, 1), p%stays)
         ! On a dead point the Jacobian has an inverse only where links that are in line turn apart.
         e%state%u(k)%value = e%state%u(k)%value + merge(singular_nudge*(-1)**k, nudge, p%is_singular)
      end do
      if (p%direction > 0) call put_loops_off(p%direction, e%blocks%numbers)
      call set_drive_values(e, q%t)
      missing = missing_nothing
      do k = 1, size(e%needed)
         associate (i => e%needed(k), block => e%blocks%list(e%needed(k)))
            lack = largest_known(e%blocks, i, missing)
            if (p%only_driven .and. .not. block%direct) lack = missing_all
            if (lack < missing_all) then
               c = convergence_t()
               call solve_block(e%blocks, i, 0.0_wp, e%work, e%state, c)
               p%ratio = max(p%ratio, c%kantorovich_ratio)
               p%change = max(p%change, c%change)
               p%jams = p%jams .or. c%ended == ended_inconsistent .or. c%rates_open
               if (c%singular) lack = missing_rates
               if (.not. is_solved(c) .or. c%rates_open) lack = missing_all
               if (block%shape%rows > block%shape%n .and. lack < missing_rates) call refine_rates(e, i)
               if (p%is_singular) then
                  if (c%change > singular_change) lack = missing_all
               else if (c%kantorovich_ratio > largest_ratio .and. .not. c%singular) then
                  lack = missing_all
               end if
            end if
            missing(e%blocks%unknown(block%first:block%last)) = lack
         end associate
      end do
      call get_motion(e, q, finite)
      call mark_links(e%chain, missing, q)
   end subroutine solve_needed

   !> The rates of block `i` of `e` again, by iterative refinement. Orthogonal factors, of equations that are too many,
   !> leave errors by the largest of all rows; one pass leaves those of each row (Higham, Accuracy and Stability of
   !> Numerical Algorithms, 2002, ch. 20).
   subroutine refine_rates(e, i)
      type(block_engine_t), intent(inout) :: e
      integer, intent(in) :: i
      real(wp), allocatable :: jacobian(:, :)
      integer :: order, k, info

      associate (block => e%blocks%list(i), shape => e%blocks%list(i)%shape, w => e%work)
         call assemble_block(e%blocks, i, e%state, w%a, w%r)
         jacobian = reshape(w%a(:shape%rows*shape%n), [shape%rows, shape%n])
         call solve_first(shape, w%a, w%sparse(shape%pattern), w%pivots, w%work, w%r, info)
         if (info > 0) return
         do order = 1, 2
            call right_hand_side(e%blocks, i, order, e%state, w%r)
            do k = 1, shape%n
               associate (u => e%state%u(e%blocks%unknown(block%first + k - 1)))
                  w%r(:shape%rows) = w%r(:shape%rows) - merge(u%rate, u%acceleration, order == 1)*jacobian(:, k)
               end associate
            end do
            call solve_again(shape, w%a, w%sparse(shape%pattern), w%pivots, w%work, w%r)
            do k = 1, shape%n
               associate (u => e%state%u(e%blocks%unknown(block%first + k - 1)))
                  if (order == 1) u%rate = u%rate + w%r(k)
                  if (order == 2) u%acceleration = u%acceleration + w%r(k)
               end associate
            end do
         end do
      end associate
   end subroutine refine_rates
end module changed_rows
