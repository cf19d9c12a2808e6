!> The error estimate: how far the numbers of a motion are known. It solves the rows of mechanisms whose numbers are
!> off by roundings, at instants at which digits of the tables could be lost or errors are requested (--errors).
module error_estimate
   use assertions, only: asserts, assert
   use kinds, only: wp
   use mechanism, only: mechanism_t, is_sum_of_numbers, largest_summand
   use motion, only: motion_t
   use columns, only: columns_of_rows, forms, kinds_of_rows
   use points, only: row_t, find_row, known_at, difference
   use instant_centres, only: centre_finite, centre_infinite, centre_starting, points_coincide
   use masked_numbers, only: nothing_known, errors_a_digit
   use significance_check, only: sizes_t, sizes_of, find_amplification
   use blocks, only: blocks_t, geometry_t
   use block_state, only: state_t
   use changed_rows, only: perturbed_t, base_position_t, find_place, make_ready, assign_changes, rows_with
   use rounded_numbers, only: directions, own_directions, safety_factor, own_safety_factor, calculation_safety_factor, &
      perturb_numbers, perturb_sums
   implicit none
   private
   public :: error_estimate_t, estimator_t, make_estimator, estimate_errors, estimate_of, row_error

   !> Numbers are off by so many roundings: compared with them the roundings of the calculation are small.
   real(wp), parameter :: many_roundings = 256.0_wp
   !> Numbers are off by so few roundings if changes by many have a larger Kantorovich ratio than `linear_ratio`, as
   !> 1E-12 from a dead point: with a smaller ratio changes are of first order, but for about this part.
   real(wp), parameter :: few_roundings = 16.0_wp, linear_ratio = 0.05_wp
   !> A sum is off by so many roundings of its largest number. With 0.9 the estimates of `make errors` are above all
   !> true errors, and 7 to 10 times as large in the mean.
   real(wp), parameter :: roundings_of_sum = 0.9_wp
   !> For the closure error, lengths and directions are off by the closure error over this.
   real(wp), parameter :: closure_parts = 8.0_wp
   !> The roundings of a drawing may be larger than its closure error: all of 140 drawings are within this factor.
   real(wp), parameter :: closure_safety_factor = 2.0_wp
   !> The last digit that is shown is worth so many errors by the closure error: with as many as of roundings nothing of
   !> a drawing would be shown.
   real(wp), parameter :: closure_errors_a_digit = 1.0_wp

   !> How far the motion at one instant is known.
   type :: error_estimate_t
      logical :: taken = .false.             !< an estimate was made
      logical :: asked = .false.             !< --errors: an estimate is requested at every instant
      real(wp) :: amplification = 0.0_wp            !< factor of roundings at this instant; huge if numbers are large
      type(sizes_t) :: sizes                 !< if `taken`: characteristic sizes, with which numbers are compared
      logical :: may_lose_digits = .false.          !< digits of the tables may be lost: these are masked
      !> (3, 0:2, requests) The largest change by a rounding of all numbers, or `nothing_known`.
      real(wp), allocatable :: changes(:, :, :)
      !> (3, 0:2, requests) --errors: the error by numbers, and by the roundings of the calculation itself. Reason:
      !> rates of links that turn as one have no other error.
      real(wp), allocatable :: own(:, :, :)
      !> (3, 0:2, requests) The largest change by lengths and directions off by the closure error; 0 without one.
      real(wp), allocatable :: by_closure(:, :, :)
      type(row_t), allocatable :: solved(:)  !< (requests) the rows solved to the limit of rounding
   end type error_estimate_t

   !> The data that all estimates of a mechanism share.
   type :: estimator_t
      type(sizes_t) :: sizes                 !< characteristic sizes of the mechanism
      real(wp) :: closure = 0.0_wp           !< largest closure error in its run (characteristic lengths, rad), or 0
      type(base_position_t) :: place         !< the position of the last estimate
      !> (0:directions + own_directions) or (0:0), after the first estimate. Number 0 has numbers as they stand. In each
      !> direction numbers are off by many or few roundings, in each own direction by one.
      type(perturbed_t), allocatable :: perturbed(:)
   end type estimator_t

contains

   !> Prepares the estimates of a mechanism. The first estimate makes the changed mechanisms.
   subroutine make_estimator(estimator, m)
      type(estimator_t), intent(inout) :: estimator   !< new, or of a variant of equal structure
      type(mechanism_t), intent(in) :: m

      estimator%sizes = sizes_of(m)
      if (allocated(estimator%perturbed)) estimator%perturbed%is_ready = .false.
   end subroutine make_estimator

   !> Estimates how far a motion is known. No estimate is made (found%taken) if no digit may be lost, or if nothing of
   !> the motion is known.
   subroutine estimate_errors(estimator, m, b, x, state, q, always, prints_errors, found)
      type(estimator_t), intent(inout) :: estimator   !< of `m`
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(state_t), intent(in) :: state     !< of the motion
      type(motion_t), intent(in) :: q        !< the motion
      logical, intent(in) :: always          !< an estimate is made also if no digit of a table may be lost
      logical, intent(in) :: prints_errors            !< the errors themselves are printed (--errors)
      type(error_estimate_t), intent(inout) :: found   !< the estimate
      logical :: is_small

      if (asserts) call assert(size(q%position, 2) == size(m%links), 'estimate_errors: a motion of all links')
      found%taken = .false.
      found%asked = always
      call find_amplification(estimator%sizes, m, b, x, state, q, found%amplification, found%may_lose_digits)
      found%may_lose_digits = found%may_lose_digits .or. estimator%closure > 0.0_wp
      if (.not. (always .or. found%may_lose_digits)) return
      if (q%known < 0 .and. .not. allocated(q%link_known)) return

      if (.not. allocated(found%changes)) allocate (found%changes(3, 0:2, size(m%requests)), &
         found%own(3, 0:2, size(m%requests)), found%by_closure(3, 0:2, size(m%requests)), &
         found%solved(size(m%requests)))
      found%sizes = estimator%sizes
      found%taken = .true.

      call find_place(b, x, state, q, estimator%place)
      estimator%place%stays = estimator%place%is_singular
      call find_changed(estimator, m, b, x, q%t, 0, many_roundings, 0.0_wp, found%solved)
      estimator%place%stays = .false.
      call find_largest_changes(many_roundings, 0.0_wp, 1.0_wp/ratio_of_rows(many_roundings), &
         estimator%place%is_singular, found%changes, is_small)
      if (.not. is_small) call find_largest_changes(few_roundings, 0.0_wp, 1.0_wp/ratio_of_rows(few_roundings), &
         .true., found%changes, is_small)

      found%own = safety_factor*min(found%changes, nothing_known/safety_factor)
      if (prints_errors .and. .not. estimator%place%is_singular) then
         call find_own_changes()
         ! The part of own changes above the largest change by numbers comes from roundings of the calculation.
         associate (own => found%own, by_numbers => found%changes)
            own = max(own_safety_factor*own, &
               calculation_safety_factor*sqrt(max(own - by_numbers, 0.0_wp))*sqrt(own + min(by_numbers, own)))
         end associate
      end if

      call add_sums(m, b, q, found)
      found%by_closure = 0.0_wp
      if (estimator%closure > 0.0_wp) then
         ! Changes by a much smaller part of the closure error would show how the weights of equations change.
         call find_largest_changes(estimator%closure/(closure_parts*epsilon(1.0_wp)), estimator%sizes%length, &
            closure_safety_factor*ratio_of_rows(closure_parts), .true., found%by_closure, is_small)
         found%by_closure = min(found%by_closure, nothing_known)
      end if

   contains

      !> Replaces each row that has lost numbers by a change with the row of the opposite change. Reason: both changes
      !> are equally likely and large, and on a dead point only one of the two has a position.
      subroutine use_opposite(k, roundings, length, rows)
         integer, intent(in) :: k            !< the direction
         real(wp), intent(in) :: roundings   !< how many roundings numbers are off
         real(wp), intent(in) :: length      !< size that counts for all lengths, deck's unit; 0: each its own
         type(row_t), intent(inout) :: rows(:)   !< (requests) of the change in the direction
         type(row_t) :: other(size(rows))

         if (all(rows%known >= found%solved%known)) return
         call find_changed(estimator, m, b, x, q%t, k, -roundings, length, other)
         where (rows%known < found%solved%known) rows = other
      end subroutine use_opposite

      !> Gives the ratio of two changes of rows that belongs to a ratio of two changes of numbers: equal, or the root of
      !> that ratio if the Jacobian has no inverse.
      pure real(wp) function ratio_of_rows(ratio)
         real(wp), intent(in) :: ratio       !< 1 or more

         ratio_of_rows = merge(sqrt(ratio), ratio, estimator%place%is_singular)
      end function ratio_of_rows

      !> Finds the largest changes of the rows in all directions, scaled to a part. The search ends at the first change
      !> that is not of first order, unless `anyway`.
      subroutine find_largest_changes(roundings, length, part, anyway, changes, is_small)
         real(wp), intent(in) :: roundings   !< how many roundings numbers are off
         real(wp), intent(in) :: length      !< size that counts for all lengths, deck's unit; 0: each its own
         real(wp), intent(in) :: part        !< factor of the changes of the rows
         logical, intent(in) :: anyway       !< changes need not be of first order
         real(wp), intent(out) :: changes(3, 0:2, size(found%solved))   !< the largest changes, in the units of the rows
         logical, intent(out) :: is_small    !< all changes were found: of first order, or `anyway`
         type(row_t) :: rows(size(found%solved))
         integer :: k, i

         changes = 0.0_wp
         do k = 1, directions
            call find_changed(estimator, m, b, x, q%t, k, roundings, length, rows)
            is_small = anyway .or. (estimator%place%ratio <= linear_ratio .and. all(rows%known >= found%solved%known))
            if (.not. is_small) return
            call use_opposite(k, roundings, length, rows)
            do i = 1, size(rows)
               changes(:, :, i) = max(changes(:, :, i), change(rows(i), found%solved(i), part))
            end do
         end do
      end subroutine find_largest_changes

      !> Finds in found%own the root of the mean square of the changes of the rows by one rounding, in own directions.
      subroutine find_own_changes()
         type(row_t) :: rows(size(found%solved))
         integer :: k, i

         found%own = 0.0_wp
         do k = directions + 1, directions + own_directions
            call find_changed(estimator, m, b, x, q%t, k, 1.0_wp, 0.0_wp, rows)
            call use_opposite(k, 1.0_wp, 0.0_wp, rows)
            do i = 1, size(rows)
               found%own(:, :, i) = min(nothing_known, hypot(found%own(:, :, i), &
                  change(rows(i), found%solved(i), 1.0_wp)/sqrt(real(own_directions, wp))))
            end do
         end do
      end subroutine find_own_changes
   end subroutine estimate_errors

   !> Adds the changes by a rounding of sums to an estimate: the motion and its rows are sums.
   subroutine add_sums(m, b, q, found)
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(in) :: b
      type(motion_t), intent(in) :: q        !< the motion
      type(error_estimate_t), intent(inout) :: found   !< the changes are those by numbers; then also those by sums
      real(wp) :: of_sums(3, 0:2, size(m%requests))
      type(motion_t) :: other
      type(row_t) :: one, rows(size(m%requests))
      integer :: k, i

      do i = 1, size(rows)
         call find_row(m, q, m%requests(i), rows(i))
      end do
      of_sums = 0.0_wp
      do k = 1, directions
         other = q
         ! Changes by one rounding could be hidden by the roundings of the rows: sums are off by few.
         call perturb_sums(b%tree, found%sizes%length, k, few_roundings, other)
         if (allocated(q%by)) call perturb_ratios(b, q, found%sizes%length, k, other)
         do i = 1, size(rows)
            call find_row(m, other, m%requests(i), one)
            ! No sum moves a centre from infinity.
            if (rows(i)%state /= centre_finite) one%state = rows(i)%state
            of_sums(:, :, i) = max(of_sums(:, :, i), change(one, rows(i), roundings_of_sum/few_roundings))
         end do
      end do

      found%own = min(hypot(found%own, of_sums), nothing_known)
      ! In tables a rate that is zero, and that no change of the numbers changes, does not count as a sum.
      do i = 1, size(rows)
         of_sums(:, 1:, i) = merge(of_sums(:, 1:, i), 0.0_wp, abs(rows(i)%value(:, 1:)) > 0.0_wp &
            .or. found%changes(:, 1:, i) > 0.0_wp)
      end do
      found%changes = min(hypot(found%changes, of_sums), nothing_known)
   end subroutine add_sums

   !> Changes the unit motions of a motion, of which ratios are made, by roundings of sums.
   subroutine perturb_ratios(b, q, length, k, other)
      type(blocks_t), intent(in) :: b
      type(motion_t), intent(in) :: q        !< the unchanged motion, with unit motions
      real(wp), intent(in) :: length         !< characteristic length, in the deck's unit
      integer, intent(in) :: k               !< the direction
      type(motion_t), intent(inout) :: other   !< its unit motions are changed
      type(motion_t) :: unit
      integer :: d

      do d = 1, size(other%by)
         if (.not. allocated(q%by(d)%velocity)) cycle
         unit%position = q%position
         unit%velocity = q%by(d)%velocity
         unit%acceleration = q%by(d)%acceleration
         unit%known = 2
         unit%link_known = merge(2, -1, q%by(d)%is_known)
         unit%origin = q%origin
         call perturb_sums(b%tree, length, k, few_roundings, unit)
         other%by(d)%velocity = unit%velocity
         other%by(d)%acceleration = unit%acceleration
      end do
   end subroutine perturb_ratios

   !> Finds the rows near a motion with all numbers off by roundings in a direction.
   subroutine find_changed(estimator, m, b, x, t, k, roundings, length, rows)
      type(estimator_t), intent(inout) :: estimator   !< with the position of the motion; then also the findings
      type(mechanism_t), intent(in) :: m     !< the unchanged mechanism
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      real(wp), intent(in) :: t              !< time of the motion, in the deck's unit
      integer, intent(in) :: k               !< the direction; 0: no number is off
      real(wp), intent(in) :: roundings      !< how many roundings; below 0: in the opposite direction
      real(wp), intent(in) :: length         !< size that counts for all lengths, deck's unit; 0: each its own
      type(row_t), intent(inout) :: rows(:)   !< (requests) `known` of a row tells how much of it was found
      integer :: i

      call make_ready(estimator%perturbed, k, m, x, i)
      associate (p => estimator%perturbed(i))
         if (p%direction /= k .or. abs(p%roundings - roundings) + abs(p%length - length) > 0.0_wp) then
            associate (axes => x%equations%axes)
               call perturb_numbers(m, b%tree, axes, k, roundings, length, p%m, p%time_off)
            end associate
            call assign_changes(b, p, by_roundings=.true.)
            p%direction = k
            p%roundings = roundings
            p%length = length
         end if
         call rows_with(b, p, t + p%time_off*t, estimator%place, rows)
      end associate
   end subroutine find_changed

   !> Gives a part of the change (3, 0:2) of a row, in its units; `nothing_known` for numbers that the changed row has
   !> lost.
   pure function change(one, middle, part) result(x)
      type(row_t), intent(in) :: one         !< the changed row
      type(row_t), intent(in) :: middle      !< the unchanged row
      real(wp), intent(in) :: part           !< factor of their difference
      real(wp) :: x(3, 0:2)

      x = part*difference(one, middle)
      if (.not. kinds_of_rows(one%kind)%is_centre) then
         x(:, last_common(one, middle) + 1:) = nothing_known
      else
         x = merge(nothing_known, x, lost_numbers(one, middle))
      end if
   end function change

   !> Estimates the error (3, 0:2) of a row by rounding of the deck's numbers and by the closure error, in the units of
   !> the row; `nothing_known` for lost numbers. Without an estimate the error is 0, or `nothing_known` if it was
   !> requested.
   pure function estimate_of(row, m, estimate, i) result(error)
      type(row_t), intent(in) :: row         !< of the motion
      type(mechanism_t), intent(in) :: m
      type(error_estimate_t), intent(in) :: estimate   !< of the motion
      integer, intent(in) :: i               !< number of the request
      real(wp), dimension(3, 0:2) :: error

      error = 0.0_wp
      associate (request => m%requests(i))
         if (is_sum_of_numbers(m, request)) then
            error(:, 0) = max(abs(row%value(:, 0)), largest_summand(m, request))
            error(:, 0) = merge(safety_factor*epsilon(1.0_wp)*error(:, 0), 0.0_wp, abs(row%value(:, 0)) > 0.0_wp)
            return
         end if
         if (estimate%asked) error = nothing_known
         if (.not. estimate%taken) return

         error = merge(nothing_known, safety_factor*estimate%changes(:, :, i), &
            max(estimate%changes(:, :, i), estimate%by_closure(:, :, i)) >= nothing_known)
         where (error < nothing_known) &
            error = hypot(error, estimate%by_closure(:, :, i)*closure_errors_a_digit/errors_a_digit)
         if (.not. kinds_of_rows(request%kind)%is_centre) &
            error(:, min(row%known, last_common(estimate%solved(i), row)) + 1:) = nothing_known
      end associate
   end function estimate_of

   !> Gives the estimated error (3, 0:2) of a row of a motion, in the units of the row: the error by rounding and by the
   !> closure error, and the distance from the row that is solved to the limit of rounding. `nothing_known` for lost
   !> numbers.
   pure function row_error(m, estimate, q, i) result(error)
      type(mechanism_t), intent(in) :: m
      type(error_estimate_t), intent(in) :: estimate   !< of the motion, with errors (--errors)
      type(motion_t), intent(in) :: q        !< the motion
      integer, intent(in) :: i               !< number of the request
      real(wp), dimension(3, 0:2) :: error
      type(row_t) :: row

      call find_row(m, q, m%requests(i), row)
      error = estimate_of(row, m, estimate, i)
      if (.not. estimate%taken) return
      if (is_sum_of_numbers(m, m%requests(i))) return
      where (error < nothing_known) &
         error = estimate%own(:, :, i) + estimate%by_closure(:, :, i) + difference(row, estimate%solved(i))
      if (kinds_of_rows(row%kind)%is_centre) error = merge(nothing_known, error, lost_numbers(row, estimate%solved(i)))
   end function row_error

   !> Gives the highest derivative of a row that a changed row has; -1: none. If points of the changed row coincide and
   !> points of the row do not, the changed row has only the numbers that exist for coincident points.
   pure integer function last_common(one, row)
      type(row_t), intent(in) :: one         !< the changed row
      type(row_t), intent(in) :: row         !< the row

      last_common = one%known
      if (row%state /= points_coincide) last_common = known_at(one)
   end function last_common

   !> Finds the numbers (3, 0:2) of the row of a pole or curve that a changed row does not have:
   !>
   !> - all, if less of its motion is known;
   !> - positions, if only one of the two rows has its centre at infinity or rests, or if they are on two sides of
   !>   infinity;
   !> - directions, if one of the two rests.
   pure function lost_numbers(one, row) result(lost)
      type(row_t), intent(in) :: one         !< the changed row
      type(row_t), intent(in) :: row         !< the row
      logical :: lost(3, 0:2)
      integer :: first
      logical :: same_side

      lost = one%known < row%known
      same_side = row%state /= centre_finite .or. (one%weight > 0.0_wp .eqv. row%weight > 0.0_wp)
      if (one%state == row%state .and. same_side) return
      ! A position that exists even if the centre is at infinity is not the position of the centre.
      first = merge(1, 0, columns_of_rows(forms(row%form)%first)%there(centre_infinite))
      lost(:2, first:) = .true.
      if (max(one%state, row%state) >= centre_starting) lost(3, :) = .true.
   end function lost_numbers
end module error_estimate
