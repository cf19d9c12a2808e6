!> The error estimate: how far the numbers of a motion are known, by the rows of mechanisms whose numbers are off by
!> roundings, at instants where digits of the tables could be in doubt or where the errors are asked for.
module error_estimate
   use kinds, only: wp
   use mechanism, only: mechanism_t, request_point, request_measure, request_pole, is_centre
   use motion, only: motion_t
   use points, only: row_t, find_row, known_at, difference, is_fixed
   use instant_centres, only: centre_finite, centre_starting, points_coincide
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

   !> Numbers are off by so many roundings, beside which those of the calculation are small; 1E-12 from a dead point, or
   !> where their changes have a larger Kantorovich ratio, by few: changes are of first order but for about that part.
   real(wp), parameter :: many = 256.0_wp, few = 16.0_wp, small_ratio = 0.05_wp
   !> A sum is off by so many roundings of its largest number. So the estimates of `make errors` are above all the true
   !> errors, and 7 to 10 times these in the mean.
   real(wp), parameter :: of_sum = 0.9_wp
   !> Roundings of a drawing may leave equations open by less than they are: of 140 drawings all are within the factor.
   real(wp), parameter :: closure_parts = 8.0_wp, closure_caution = 2.0_wp
   !> The last digit that is shown is worth so many errors by the closure error: as many as of roundings would leave
   !> nothing of a drawing.
   real(wp), parameter :: closure_errors_a_digit = 1.0_wp
   !> How far the motion at one instant is known. It is `taken` where digits of the tables could be `in_doubt`, which
   !> are masked then, or where the errors are `asked` for, if anything moves.
   type :: error_estimate_t
      logical :: taken = .false.             !< `changes` tell something
      logical :: asked = .false.             !< --errors: wanted at every instant
      real(wp) :: growth = 0.0_wp            !< of roundings at this instant; huge where numbers are large
      type(sizes_t) :: sizes                 !< what numbers are compared with, where `taken`
      logical :: in_doubt = .false.          !< it is so much that digits may be lost
      !> (3, 0:2, requests) What a rounding of all numbers changes at most; `nothing_known`, where it is so.
      real(wp), allocatable :: changes(:, :, :)
      !> (3, 0:2, requests) --errors: how far numbers are known, with the roundings of the calculation itself: rates of
      !> links that turn as one have no other error.
      real(wp), allocatable :: own(:, :, :)
      !> (3, 0:2, requests) What lengths and directions off by the closure error change at most; 0 without one.
      real(wp), allocatable :: by_closure(:, :, :)
      type(row_t), allocatable :: solved(:)  !< (requests) the rows solved to the limit of rounding
   end type error_estimate_t

   !> What the estimates of a mechanism need.
   type :: estimator_t
      type(sizes_t) :: sizes
      real(wp) :: closure = 0.0_wp           !< closure error at most in its run (characteristic lengths, rad), or 0
      type(base_position_t) :: place
      !> (0:directions + own_directions, or 0:0) Once an estimate has been asked for: with numbers as they stand; off in
      !> each direction by `many` or `few` roundings; off in each further direction by one.
      type(perturbed_t), allocatable :: perturbed(:)
   end type estimator_t

contains

   !> For the errors of `m`, a variant of the mechanism before if there was one; the rest is made when it is first asked
   !> for.
   subroutine make_estimator(estimator, m)
      type(estimator_t), intent(inout) :: estimator
      type(mechanism_t), intent(in) :: m

      estimator%sizes = sizes_of(m)
      if (allocated(estimator%perturbed)) estimator%perturbed%is_ready = .false.
   end subroutine make_estimator

   !> How far the motion `q` of `m` is known, the `state` of the blocks `b`. `always`: also where no digit of a table is
   !> in doubt. `told`: its errors are told themselves (--errors).
   subroutine estimate_errors(estimator, m, b, x, state, q, always, told, found)
      type(estimator_t), intent(inout) :: estimator
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(state_t), intent(in) :: state
      type(motion_t), intent(in) :: q
      logical, intent(in) :: always, told
      type(error_estimate_t), intent(inout) :: found
      logical :: is_small

      found%taken = .false.
      found%asked = always
      call find_amplification(estimator%sizes, m, b, x, state, q, found%growth, found%in_doubt)
      found%in_doubt = found%in_doubt .or. estimator%closure > 0.0_wp
      if (.not. (always .or. found%in_doubt)) return
      if (q%known < 0 .and. .not. allocated(q%link_known)) return

      if (.not. allocated(found%changes)) allocate (found%changes(3, 0:2, size(m%requests)), &
         found%own(3, 0:2, size(m%requests)), found%by_closure(3, 0:2, size(m%requests)), &
         found%solved(size(m%requests)))
      found%sizes = estimator%sizes
      found%taken = .true.
      call find_place(b, x, state, q, estimator%place)
      estimator%place%stays = estimator%place%is_singular
      call find_changed(0, many, 0.0_wp, found%solved)
      estimator%place%stays = .false.
      call find_largest_changes(many, estimator%place%is_singular, is_small)
      if (.not. is_small) call find_largest_changes(few, .true., is_small)
      found%own = safety_factor*min(found%changes, nothing_known/safety_factor)
      if (told .and. .not. estimator%place%is_singular) then
         call find_own_changes()
         ! As far as they exceed the largest change by numbers alone, the calculation has made them.
         associate (own => found%own, by_numbers => found%changes)
            own = max(own_safety_factor*own, &
               calculation_safety_factor*sqrt(max(own - by_numbers, 0.0_wp))*sqrt(own + min(by_numbers, own)))
         end associate
      end if
      call add_sums()
      found%by_closure = 0.0_wp
      if (estimator%closure > 0.0_wp) call find_changes_by_closure()

   contains

      !> The `rows` of `m` near the motion `q` with all numbers off by so many `roundings` in direction `k`; 0: with
      !> none off. `length`: see `perturb_numbers`.
      subroutine find_changed(k, roundings, length, rows)
         integer, intent(in) :: k
         real(wp), intent(in) :: roundings
         real(wp), intent(in) :: length      !< length; 0: each number is off by its own size
         type(row_t), intent(inout) :: rows(:)
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
            call rows_with(b, p, q%t + p%time_off*q%t, estimator%place, rows)
         end associate
      end subroutine find_changed

      !> Puts the opposite change in the place of each of the `rows` that has lost numbers by `find_changed`: it is as
      !> likely, and as large, and on a dead point one of the two has a position.
      subroutine use_opposite(k, roundings, length, rows)
         integer, intent(in) :: k
         real(wp), intent(in) :: roundings
         real(wp), intent(in) :: length      !< see `find_changed`
         type(row_t), intent(inout) :: rows(:)
         type(row_t) :: other(size(rows))

         if (all(rows%known >= found%solved%known)) return
         call find_changed(k, -roundings, length, other)
         where (rows%known < found%solved%known) rows = other
      end subroutine use_opposite

      !> Finds the largest changes of the rows by a rounding, from those by so many `roundings`. `is_small`: they are so
      !> small that they are of first order, if not all of them are asked for `anyway`.
      subroutine find_largest_changes(roundings, anyway, is_small)
         real(wp), intent(in) :: roundings
         logical, intent(in) :: anyway
         logical, intent(out) :: is_small
         type(row_t) :: rows(size(found%solved))
         real(wp) :: part
         integer :: k, i

         ! Where the Jacobian has no inverse a position changes with the root of what the deck changes by.
         part = 1.0_wp/merge(sqrt(roundings), roundings, estimator%place%is_singular)
         found%changes = 0.0_wp
         do k = 1, directions
            call find_changed(k, roundings, 0.0_wp, rows)
            is_small = anyway .or. (estimator%place%ratio <= small_ratio .and. all(rows%known >= found%solved%known))
            if (.not. is_small) return
            call use_opposite(k, roundings, 0.0_wp, rows)
            do i = 1, size(rows)
               found%changes(:, :, i) = max(found%changes(:, :, i), change(rows(i), found%solved(i), part))
            end do
         end do
      end subroutine find_largest_changes

      !> Finds the root of the mean square of the changes of the rows by one rounding, in further directions.
      subroutine find_own_changes()
         type(row_t) :: rows(size(found%solved))
         integer :: k, i

         found%own = 0.0_wp
         do k = directions + 1, directions + own_directions
            call find_changed(k, 1.0_wp, 0.0_wp, rows)
            call use_opposite(k, 1.0_wp, 0.0_wp, rows)
            do i = 1, size(rows)
               found%own(:, :, i) = min(nothing_known, hypot(found%own(:, :, i), &
                  change(rows(i), found%solved(i), 1.0_wp)/sqrt(real(own_directions, wp))))
            end do
         end do
      end subroutine find_own_changes

      !> Finds the largest changes of the rows by lengths and directions that are off by the closure error, from those
      !> by a part of it. A much smaller part would show how the weights of equations change, which goes with the error.
      subroutine find_changes_by_closure()
         type(row_t) :: rows(size(found%solved))
         real(wp) :: roundings, times
         integer :: k, i

         roundings = estimator%closure/(closure_parts*epsilon(1.0_wp))
         times = closure_caution*merge(sqrt(closure_parts), closure_parts, estimator%place%is_singular)
         do k = 1, directions
            call find_changed(k, roundings, estimator%sizes%length, rows)
            call use_opposite(k, roundings, estimator%sizes%length, rows)
            do i = 1, size(rows)
               found%by_closure(:, :, i) = max(found%by_closure(:, :, i), change(rows(i), found%solved(i), times))
            end do
         end do
         found%by_closure = min(found%by_closure, nothing_known)
      end subroutine find_changes_by_closure

      !> Adds to both changes those by a rounding of the sums that the motion and its rows are.
      subroutine add_sums()
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
            ! By one they could be hidden by the roundings of the rows.
            call perturb_sums(b%tree, estimator%sizes%length, k, few, other)
            if (allocated(q%by)) call perturb_ratios(k, other)
            do i = 1, size(rows)
               call find_row(m, other, m%requests(i), one)
               ! No sum moves a centre from infinity.
               if (rows(i)%state /= centre_finite) one%state = rows(i)%state
               of_sums(:, :, i) = max(of_sums(:, :, i), change(one, rows(i), of_sum/few))
            end do
         end do
         found%own = min(hypot(found%own, of_sums), nothing_known)
         ! For the tables a rate that is zero, and that no change of the numbers changes, is no sum.
         do i = 1, size(rows)
            of_sums(:, 1:, i) = merge(of_sums(:, 1:, i), 0.0_wp, abs(rows(i)%value(:, 1:)) > 0.0_wp &
               .or. found%changes(:, 1:, i) > 0.0_wp)
         end do
         found%changes = min(hypot(found%changes, of_sums), nothing_known)
      end subroutine add_sums

      !> Puts the motions by which ratios are taken off by roundings of the sums that they are, as the motion `other`.
      subroutine perturb_ratios(k, other)
         integer, intent(in) :: k            !< the direction
         type(motion_t), intent(inout) :: other
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
            call perturb_sums(b%tree, estimator%sizes%length, k, few, unit)
            other%by(d)%velocity = unit%velocity
            other%by(d)%acceleration = unit%acceleration
         end do
      end subroutine perturb_ratios
   end subroutine estimate_errors

   !> The change (3, 0:2) by a rounding, from the rows `middle` and `one`, of which a `part` is that of one rounding.
   pure function change(one, middle, part) result(x)
      type(row_t), intent(in) :: one, middle
      real(wp), intent(in) :: part
      real(wp) :: x(3, 0:2)

      x = part*difference(one, middle)
      if (.not. is_centre(one%kind)) then
         x(:, last_common(one, middle) + 1:) = nothing_known
      else
         x = merge(nothing_known, x, lost_numbers(one, middle))
      end if
   end function change

   !> Estimates what rounding of the deck's numbers leaves open (3, 0:2) of the `row` of request number `i` of `m`,
   !> in its units. `nothing_known`, where it is so.
   pure function estimate_of(row, m, estimate, i) result(error)
      type(row_t), intent(in) :: row
      type(mechanism_t), intent(in) :: m
      type(error_estimate_t), intent(in) :: estimate
      integer, intent(in) :: i
      real(wp), dimension(3, 0:2) :: error

      error = 0.0_wp
      associate (request => m%requests(i))
         if (is_fixed(m, request) .and. request%kind /= request_measure) then
            ! A sum of numbers of cards.
            error(:, 0) = abs(row%value(:, 0))
            if (request%kind == request_point) error(:, 0) = max(error(:, 0), norm2(m%points(request%subject)%offset), &
               norm2(m%links(m%points(request%subject)%link)%position(:2)))
            error(:, 0) = merge(safety_factor*epsilon(1.0_wp)*error(:, 0), 0.0_wp, abs(row%value(:, 0)) > 0.0_wp)
            return
         end if
         if (estimate%asked) error = nothing_known
         if (.not. estimate%taken) return
         error = merge(nothing_known, safety_factor*estimate%changes(:, :, i), max(estimate%changes(:, :, i), &
            estimate%by_closure(:, :, i)) &
            >= nothing_known)
         where (error < nothing_known) error = hypot(error, estimate%by_closure(:, :, &
            i)*closure_errors_a_digit/errors_a_digit)
         if (.not. is_centre(request%kind)) &
            error(:, min(row%known, last_common(estimate%solved(i), row)) + 1:) = nothing_known
      end associate
   end function estimate_of

   !> The estimated error (3, 0:2) of the row of the motion `q`: what rounding leaves open, and how far the row is from
   !> that of the motion solved to the limit of rounding.
   pure function row_error(m, estimate, q, i) result(error)
      type(mechanism_t), intent(in) :: m
      type(error_estimate_t), intent(in) :: estimate
      type(motion_t), intent(in) :: q
      integer, intent(in) :: i
      real(wp), dimension(3, 0:2) :: error
      type(row_t) :: row

      call find_row(m, q, m%requests(i), row)
      error = estimate_of(row, m, estimate, i)
      if (.not. estimate%taken) return
      if (is_fixed(m, m%requests(i)) .and. row%kind /= request_measure) return
      where (error < nothing_known) error = estimate%own(:, :, i) + estimate%by_closure(:, :, i) + difference(row, &
         estimate%solved(i))
      if (is_centre(m%requests(i)%kind)) error = merge(nothing_known, error, lost_numbers(row, estimate%solved(i)))
   end function row_error

   !> Finds how much of a row a sample tells of, as in `row_t`: where points of the sample coincide and those of the row
   !> do not, only what exists there.
   pure integer function last_common(one, row)
      type(row_t), intent(in) :: one         !< the sample
      type(row_t), intent(in) :: row

      last_common = one%known
      if (row%state /= points_coincide) last_common = known_at(one)
   end function last_common

   !> The numbers (3, 0:2) of the pole or curve `row` of which a sample with the row `one` leaves nothing: all, where it
   !> has no such motion; places, where one of the two has its centre at infinity, or rests, and the other not, or they
   !> are on two sides of infinity; and directions, where one rests.
   pure function lost_numbers(one, row) result(lost)
      type(row_t), intent(in) :: one, row
      logical :: lost(3, 0:2)
      integer :: first
      logical :: same_side

      lost = one%known < row%known
      same_side = row%state /= centre_finite .or. (one%weight > 0.0_wp .eqv. row%weight > 0.0_wp)
      if (one%state == row%state .and. same_side) return
      first = merge(0, 1, row%kind == request_pole)
      lost(:2, first:) = .true.
      if (max(one%state, row%state) >= centre_starting) lost(3, :) = .true.
   end function lost_numbers
end module error_estimate
