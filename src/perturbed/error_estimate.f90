!> The error estimate: how far the numbers of a motion are known, by the rows of mechanisms whose numbers are off by
!> roundings, at instants where digits of the tables could be in doubt or where the errors are asked for.
module error_estimate
   use kinds, only: wp
   use mechanism, only: mechanism_t, request_link, request_pair, request_pole
   use motion, only: motion_t
   use points, only: row_t, find_row, difference, is_fixed
   use sum_errors, only: errors_of_sums, error_of_sums, fixed_error, lost_numbers
   use known_digits, only: nothing_known
   use digits_in_doubt, only: sizes_t, sizes_of, find_growth
   use block_engine, only: block_engine_t
   use changed_rows, only: perturbed_t, at_hand_t, find_place, make_ready, put_changes, rows_with
   use rounded_numbers, only: directions, caution, put_off, part_off
   implicit none
   private
   public :: error_estimate_t, estimator_t, make_estimator, estimate_errors, estimate_of, row_error

   !> Numbers are off by so many roundings, beside which those of the calculation are small; 1E-12 from a dead point, or
   !> where their changes have a larger Kantorovich ratio, by few: changes are of first order but for about that part.
   real(wp), parameter :: many = 256.0_wp, few = 16.0_wp, small_ratio = 0.05_wp
   !> How far the motion at one instant is known. It is `taken` where digits of the tables could be `in_doubt`, which
   !> are masked then, or where the errors are `asked` for, if anything moves.
   type :: error_estimate_t
      logical :: taken = .false.             !< `changes` tell something
      logical :: asked = .false.             !< --errors: wanted at every instant
      logical :: without_own = .false.       !< `own` is not wanted
      real(wp) :: growth = 0.0_wp            !< of roundings at this instant; huge where numbers are large
      type(sizes_t) :: sizes                 !< what numbers are compared with, where `taken`
      logical :: in_doubt = .false.          !< it is so much that digits may be lost
      !> (length, angle or slide, derivative) The rounding error of a sum of numbers as large as the largest of the
      !> rows.
      real(wp) :: of_sums(3, 0:2) = 0.0_wp
      !> (3, 0:2, requests) What a rounding of all numbers changes at most; `nothing_known`, where it is so.
      real(wp), allocatable :: changes(:, :, :)
      type(row_t), allocatable :: solved(:)  !< (requests) the rows solved to the limit of rounding
      !> (3, 0:2, requests) Changes of the rows if all numbers are off by one rounding, if errors are asked for. What
      !> exceeds `changes` is rounding of the calculation; rates of links that turn as one have no other error.
      real(wp), allocatable :: own(:, :, :)
   end type error_estimate_t

   !> What the estimates of a mechanism need.
   type :: estimator_t
      type(sizes_t) :: sizes
      type(at_hand_t) :: place
      !> (0:2*directions, or 0:0) Once an estimate has been asked for: with numbers as they stand; off in each direction
      !> by `many` or `few` roundings; off in each direction by one.
      type(perturbed_t), allocatable :: perturbed(:)
   end type estimator_t

contains

   !> For the errors of `m`, a variant of the mechanism before if there was one; the rest is made when it is first asked
   !> for.
   subroutine make_estimator(s, m)
      type(estimator_t), intent(inout) :: s
      type(mechanism_t), intent(in) :: m

      s%sizes = sizes_of(m)
      if (allocated(s%perturbed)) s%perturbed%is_ready = .false.
   end subroutine make_estimator

   !> How far the motion `q` of `m` is known, which the `engine` has found. `always`: also where no digit of a table is
   !> in doubt; then with what `row_error` needs, unless found%without_own says that `estimate_of` is enough.
   subroutine estimate_errors(s, m, engine, q, always, found)
      type(estimator_t), intent(inout) :: s
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: engine
      type(motion_t), intent(in) :: q
      logical, intent(in) :: always
      type(error_estimate_t), intent(inout) :: found
      logical :: is_small

      found%taken = .false.
      found%asked = always
      call find_growth(s%sizes, m, engine, q, found%growth, found%in_doubt)
      if (.not. (always .or. found%in_doubt)) return
      if (q%known < 0 .and. .not. allocated(q%link_known)) return

      if (.not. allocated(found%changes)) allocate (found%changes(3, 0:2, size(m%requests)), &
         found%solved(size(m%requests)))
      found%sizes = s%sizes
      found%taken = .true.
      call find_place(engine, q, s%place)
      s%place%stays = s%place%is_singular
      call find_changed(0, many, found%solved)
      found%of_sums = errors_of_sums(m, q, s%sizes%length, found%solved)
      s%place%stays = .false.
      call find_changes(many, s%place%is_singular, found%changes, is_small)
      if (.not. is_small) call find_changes(few, .true., found%changes, is_small)
      if (.not. always .or. found%without_own) return
      if (.not. allocated(found%own)) allocate (found%own, mold=found%changes)
      found%own = 0.0_wp
      if (.not. s%place%is_singular) call find_changes(1.0_wp, .true., found%own, is_small)

   contains

      !> The `rows` of `m` near the motion `q` with all numbers off by so many `roundings` in direction `k`; 0: with
      !> none off.
      subroutine find_changed(k, roundings, rows)
         integer, intent(in) :: k
         real(wp), intent(in) :: roundings
         type(row_t), intent(inout) :: rows(:)
         integer :: i

         call make_ready(s%perturbed, merge(k, k + directions, abs(roundings) > 1.0_wp), m, engine, i)
         associate (p => s%perturbed(i))
            if (p%direction /= k .or. abs(p%roundings - roundings) > 0.0_wp) then
               associate (blocks => engine%blocks)
                  call put_off(m, blocks%tree, blocks%numbers%equations%axes, k, roundings, p%m)
               end associate
               call put_changes(p, by_roundings=.true.)
               p%time_off = 0.0_wp
               if (k > 0) p%time_off = roundings*part_off(k)
               p%direction = k
               p%roundings = roundings
            end if
            call rows_with(p, q%t + p%time_off*q%t, s%place, rows)
         end associate
      end subroutine find_changed

      !> The `changes` (3, 0:2, requests) of the rows by a rounding, from those by so many `roundings`. `is_small`: they
      !> are so small that they are of first order, if not all of them are asked for `anyway`.
      subroutine find_changes(roundings, anyway, changes, is_small)
         real(wp), intent(in) :: roundings
         logical, intent(in) :: anyway
         real(wp), intent(out) :: changes(:, 0:, :)
         logical, intent(out) :: is_small
         type(row_t), dimension(size(found%solved)) :: rows, other
         real(wp) :: part, x(3, 0:2)
         integer :: k, i

         ! Where the Jacobian has no inverse a position changes with the root of what the deck changes by.
         part = 1.0_wp/merge(sqrt(roundings), roundings, s%place%is_singular)
         changes = 0.0_wp
         do k = 1, directions
            call find_changed(k, roundings, rows)
            is_small = anyway .or. s%place%ratio <= small_ratio
            if (.not. is_small) return
            if (s%place%is_singular .and. any(rows%known < 0)) then
               ! On a dead point one of two opposite changes has a position.
               call find_changed(k, -roundings, other)
               where (rows%known < 0) rows = other
            end if
            do i = 1, size(rows)
               associate (one => rows(i), middle => found%solved(i))
                  x = part*difference(one, middle)
                  if (one%kind < request_pole) then
                     x(:, one%known + 1:) = nothing_known
                  else
                     x = merge(nothing_known, x, lost_numbers(one, middle))
                  end if
                  changes(:, :, i) = max(changes(:, :, i), x)
               end associate
            end do
         end do
      end subroutine find_changes
   end subroutine estimate_errors

   !> Estimates what rounding of the deck's numbers leaves open (3, 0:2) of the `row` of request number `i` of `m`,
   !> in its units. `nothing_known`, where it is so.
   pure function estimate_of(row, m, s, i) result(error)
      type(row_t), intent(in) :: row
      type(mechanism_t), intent(in) :: m
      type(error_estimate_t), intent(in) :: s
      integer, intent(in) :: i
      real(wp), dimension(3, 0:2) :: error
      logical :: is_zero(3, 0:2)

      error = 0.0_wp
      associate (request => m%requests(i))
         if (is_fixed(m, request)) then
            error(:, 0) = fixed_error(m, request)
            return
         end if
         if (s%asked) error = nothing_known
         if (.not. s%taken) return
         associate (largest => s%changes(:, :, i))
            error = caution*largest + error_of_sums(s%of_sums, request, row)
            ! A coordinate of what stands still is zero without a sum; an angle may be one that cancels. A coordinate of
            ! what moves is zero by chance only.
            is_zero = .not. (abs(row%value) > 0.0_wp .or. largest > 0.0_wp)
            is_zero(:, 0) = all(is_zero, dim=2)
            if (request%kind == request_link) is_zero(3, 0) = .false.
            if (request%kind == request_pair .and. row%angular) is_zero(1, 0) = .false.
            where (is_zero) error = 0.0_wp
            where (largest >= nothing_known) error = nothing_known
         end associate
         if (request%kind < request_pole) error(:, min(row%known, s%solved(i)%known) + 1:) = nothing_known
      end associate
   end function estimate_of

   !> The estimated error (3, 0:2) of the row of the motion `q`: what rounding leaves open, and how far the row is from
   !> that of the motion solved to the limit of rounding.
   pure function row_error(m, s, q, i) result(error)
      type(mechanism_t), intent(in) :: m
      type(error_estimate_t), intent(in) :: s
      type(motion_t), intent(in) :: q
      integer, intent(in) :: i
      real(wp), dimension(3, 0:2) :: error, least
      type(row_t) :: row

      call find_row(m, q, m%requests(i), row)
      error = estimate_of(row, m, s, i)
      if (.not. s%taken .or. is_fixed(m, m%requests(i))) return
      ! A rate that is zero may be a sum that cancels; a coordinate that is zero without a sum stays so.
      least = max(caution*(s%own(:, :, i) - s%changes(:, :, i)), error_of_sums(s%of_sums, m%requests(i), row))
      where (error(:, 0) <= 0.0_wp) least(:, 0) = 0.0_wp
      where (error < nothing_known) error = max(error, least) + difference(row, s%solved(i))
      if (m%requests(i)%kind >= request_pole) error = merge(nothing_known, error, lost_numbers(row, s%solved(i)))
   end function row_error
end module error_estimate
