!> The error estimate: how far the numbers of a motion are known, by its first-order response to the roundings of the
!> deck's numbers and of the calculation, at instants where digits of the tables could be in doubt or where the errors
!> are asked for.
module error_estimate
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_newton, request_t, request_link, request_pair, request_pole, request_links
   use motion, only: motion_t, new_motion
   use points, only: row_t, row_of, set_values, difference, is_fixed
   use sum_errors, only: errors_of_sums, error_of_sums, fixed_error, lost_numbers
   use known_digits, only: nothing_known
   use digits_in_doubt, only: sizes_t, sizes_of, find_growth
   use safe_digits, only: safe_digits_t, make_safe_digits, are_digits_safe
   use block_engine, only: block_engine_t
   use link_motion, only: move_found_links
   use card_roundings, only: directions, roundings, caution, own_in_tables
   use row_changes, only: change_row
   use rounding_response, only: rounding_response_t, make_rounding_response, respond_to_roundings
   implicit none
   private
   public :: error_estimate_t, estimator_t, make_estimator, estimate_errors, estimate_of, row_error, largest_errors

   !> Instant centres and centres of curvature are compared at so many roundings to either side.
   real(wp), parameter :: few = 4.0_wp
   !> Bounds that say no take 0.4 of a step: so many instants pass at most before they are asked again.
   integer, parameter :: longest_pause = 15

   !> How far the motion at one instant is known. It is `taken` where digits of the tables could be `in_doubt`, which
   !> are masked then, or where the errors are `asked` for, if anything moves.
   type :: error_estimate_t
      logical :: taken = .false.             !< `changes` tell something
      logical :: asked = .false.             !< --errors: wanted at every instant
      real(wp) :: growth = 0.0_wp            !< of roundings at this instant; huge where numbers are large
      type(sizes_t) :: sizes                 !< what numbers are compared with, where `taken`
      logical :: in_doubt = .false.          !< it is so much that digits may be lost
      !> (length, angle or slide, derivative) The rounding error of a sum of numbers as large as the largest of the
      !> rows.
      real(wp) :: of_sums(3, 0:2) = 0.0_wp
      !> (directions, 3, 0:2, links) What `roundings` roundings change of x, y, phi and their derivatives.
      real(wp), allocatable :: changes(:, :, :, :)
      real(wp), allocatable :: own(:, :, :, :)       !< the calculation's own alone, and all; where errors are asked for
      logical, allocatable :: lost(:)        !< (links) nothing is known of their changes
      type(motion_t) :: solved               !< the motion to the limit of rounding, where errors are asked for
   end type error_estimate_t

   !> What the estimates of a mechanism need.
   type :: estimator_t
      type(sizes_t) :: sizes
      type(rounding_response_t) :: response
      type(safe_digits_t) :: safe
      integer :: pause = 0, next_pause = 0     !< instants until bounds are asked again, and from there on
      logical :: is_ready = .false.            !< for any position, where blocks find it
   end type estimator_t

contains

   !> For the errors of `m`; the rest is made when it is first asked for.
   subroutine make_estimator(s, m)
      type(estimator_t), intent(out) :: s
      type(mechanism_t), intent(in) :: m

      s%sizes = sizes_of(m)
   end subroutine make_estimator

   !> How far the motion `q` of `m` is known, which the `engine` has found, by a matrix of the reciprocal condition
   !> `rcond`. `always`: also where no digit of a table is in doubt. `for_tables`: not where bounds show all digits of
   !> the tables safe.
   subroutine estimate_errors(s, m, engine, rcond, q, always, found, for_tables)
      type(estimator_t), intent(inout) :: s
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: engine
      real(wp), intent(in) :: rcond
      type(motion_t), intent(in) :: q
      logical, intent(in) :: always
      type(error_estimate_t), intent(inout) :: found
      logical, intent(in), optional :: for_tables
      real(wp) :: numbers(2, 0:2)
      logical :: by_blocks

      found%taken = .false.
      found%asked = always
      by_blocks = m%method == method_newton
      if (by_blocks) then
         call find_growth(s%sizes, m, rcond, q, found%growth, found%in_doubt, engine, numbers)
      else
         call find_growth(s%sizes, m, rcond, q, found%growth, found%in_doubt)
      end if
      if (.not. (always .or. found%in_doubt)) return
      if (q%known < 0 .and. .not. allocated(q%link_known)) return
      if (.not. s%is_ready) then
         call make_rounding_response(s%response, m, engine)
         if (by_blocks) call make_safe_digits(s%safe, m, engine)
      end if
      s%is_ready = .true.
      s%response%state%u(:) = engine%state%u
      if (present(for_tables) .and. by_blocks .and. .not. always) then
         if (are_tables_safe(s, m, engine, q, numbers)) return
      end if
      call take_changes(s%response, m, engine, q, s%sizes, always .or. .not. by_blocks, found)
   end subroutine estimate_errors

   !> `are_digits_safe`; where they have not been, the next instants are not asked for: the answer is seldom another,
   !> and the estimate decides.
   logical function are_tables_safe(s, m, e, q, numbers) result(safe)
      type(estimator_t), intent(inout) :: s
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      type(motion_t), intent(in) :: q
      real(wp), intent(in) :: numbers(2, 0:2)

      safe = .false.
      s%pause = s%pause - 1
      if (s%pause >= 0) return
      safe = are_digits_safe(s%safe, s%response, m, e, q, numbers)
      s%next_pause = merge(0, min(longest_pause, 2*s%next_pause + 1), safe)
      s%pause = s%next_pause
   end function are_tables_safe

   !> The changes at the motion `q` of `m`, with the blocks of `e` and its characteristic `sizes`. `again`: the blocks
   !> are solved once more, to the limit of rounding.
   subroutine take_changes(r, m, e, q, sizes, again, found)
      type(rounding_response_t), intent(inout) :: r
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      type(motion_t), intent(in) :: q
      type(sizes_t), intent(in) :: sizes
      logical, intent(in) :: again
      type(error_estimate_t), intent(inout) :: found
      logical :: finite

      if (.not. allocated(found%changes)) then
         allocate (found%changes(directions, 3, 0:2, size(m%links)), source=0.0_wp)
         allocate (found%lost(size(m%links)))
      end if
      r%own = own_in_tables
      call respond_to_roundings(r, m, e, q, q%known < 0, again, found%changes, found%lost)
      found%of_sums = errors_of_sums(m, q, sizes%length)
      found%sizes = sizes
      found%taken = .true.
      if (.not. found%asked) return
      if (.not. allocated(found%own)) allocate (found%own, source=found%changes)
      r%own = 1.0_wp + own_in_tables
      call respond_to_roundings(r, m, e, q, q%known < 0, again, found%own, found%lost)
      found%own = found%own - found%changes
      found%solved = new_motion(size(m%links))
      found%solved%known = 2
      call move_found_links(e%chain, found%lost, r%state, e%length, found%solved, finite)
   end subroutine take_changes

   !> What rounding of the deck's numbers leaves open (3, 0:2) of the `row` that `request` asks for of the motion `q`,
   !> in its units: the conditioning of the mechanism, whatever program has solved it. `nothing_known`, where it is so.
   !> `all_own`: with all of this calculation's own roundings.
   pure function estimate_of(row, m, s, q, request, all_own) result(error)
      type(row_t), intent(in) :: row
      type(mechanism_t), intent(in) :: m
      type(error_estimate_t), intent(in) :: s
      type(motion_t), intent(in) :: q
      type(request_t), intent(in) :: request
      logical, intent(in), optional :: all_own
      real(wp), dimension(3, 0:2) :: error, largest, of_own
      logical, dimension(3, 0:2) :: lost, lost_by_own, is_zero

      error = 0.0_wp
      if (is_fixed(m, request)) then
         error(:, 0) = fixed_error(m, request)
         return
      end if
      if (s%asked) error = nothing_known
      if (.not. s%taken) return
      error = nothing_known
      if (any(s%lost(request_links(m, request)))) return
      call find_largest(m, q, request, row, s%changes, largest, lost)
      if (present(all_own)) then
         call find_largest(m, q, request, row, s%own, of_own, lost_by_own)
         largest = max(largest, of_own)
         lost = lost .or. lost_by_own
      end if
      error = caution*largest + error_of_sums(s%of_sums, request, row)
      ! A coordinate of what stands still is zero without a sum; an angle may be one that cancels.
      is_zero = .not. (abs(row%value) > 0.0_wp .or. largest > 0.0_wp)
      if (request%kind == request_link) is_zero(3, 0) = .false.
      if (request%kind == request_pair .and. row%angular) is_zero(1, 0) = .false.
      where (is_zero) error = 0.0_wp
      if (request%kind < request_pole) error(:, row%known + 1:) = nothing_known
      if (request%kind >= request_pole) error = merge(nothing_known, error, lost)
   end function estimate_of

   !> By how much (3, 0:2) a rounding changes the `row` of `request` of the motion `q` at most, whose links change by
   !> `links` (directions, 3, 0:2, links). `lost`: it leaves nothing of it.
   pure subroutine find_largest(m, q, request, row, links, largest, lost)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(request_t), intent(in) :: request
      type(row_t), intent(in) :: row
      real(wp), intent(in) :: links(directions, 3, 0:2, *)
      real(wp), intent(out) :: largest(3, 0:2)
      logical, intent(out) :: lost(3, 0:2)
      real(wp) :: x(directions, 3, 0:2)

      lost = .false.
      if (request%kind == request_link) then
         call take_largest(links(1, 1, 0, request%subject), largest)
      else
         if (request%kind < request_pole) then
            call change_row(m, q, request, links, x)
         else
            call change_centre(m, q, request, row, links, x, lost)
         end if
         call take_largest(x, largest)
      end if
   end subroutine find_largest

   !> The `largest` (9) of changes `x` (directions, 9), over `roundings`.
   pure subroutine take_largest(x, largest)
      real(wp), intent(in) :: x(directions, 9)
      real(wp), intent(out) :: largest(9)
      real(wp) :: half(directions/2)
      integer :: c, d

      do c = 1, 9
         do d = 1, directions/2
            half(d) = max(abs(x(d, c)), abs(x(d + directions/2, c)))
         end do
         largest(c) = max(max(half(1), half(2)), max(half(3), half(4)))/roundings
      end do
   end subroutine take_largest

   !> The changes `x` (directions, 3, 0:2) of the pole or curve `row`. To both sides: roundings that change much, but
   !> together, leave what depends on ratios as it is.
   pure subroutine change_centre(m, q, request, row, links, x, lost)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(request_t), intent(in) :: request
      type(row_t), intent(in) :: row
      real(wp), intent(in) :: links(directions, 3, 0:2, size(m%links))
      real(wp), intent(out) :: x(directions, 3, 0:2)
      logical, intent(inout) :: lost(3, 0:2)
      type(row_t) :: up, down
      type(motion_t) :: above, below
      integer :: which(3), k, i

      up = row
      down = row
      above = q
      below = q
      which = request_links(m, request)
      do k = 1, directions
         do i = 1, size(which)
            call move_link(q, links(k, :, :, which(i)), few/roundings, which(i), above)
            call move_link(q, links(k, :, :, which(i)), -few/roundings, which(i), below)
         end do
         call set_values(m, above, request, up)
         call set_values(m, below, request, down)
         x(k, :, :) = difference(up, down)*(roundings/(2.0_wp*few))
         lost = lost .or. lost_numbers(up, row) .or. lost_numbers(down, row)
      end do
   end subroutine change_centre

   !> `moved` becomes the motion `q` with this `part` of the changes `x` (3, 0:2) of link number `i`.
   pure subroutine move_link(q, x, part, i, moved)
      type(motion_t), intent(in) :: q
      real(wp), intent(in) :: x(3, 0:2), part
      integer, intent(in) :: i
      type(motion_t), intent(inout) :: moved

      moved%position(:, i) = q%position(:, i) + part*x(:, 0)
      moved%velocity(:, i) = q%velocity(:, i) + part*x(:, 1)
      moved%acceleration(:, i) = q%acceleration(:, i) + part*x(:, 2)
   end subroutine move_link

   !> The estimated error (3, 0:2) of the row of the motion `q`: what rounding leaves open, and how far the row is from
   !> that of the motion solved to the limit of rounding.
   pure function row_error(m, s, q, request) result(error)
      type(mechanism_t), intent(in) :: m
      type(error_estimate_t), intent(in) :: s
      type(motion_t), intent(in) :: q
      type(request_t), intent(in) :: request
      real(wp) :: error(3, 0:2)
      type(row_t) :: row, solved

      row = row_of(m, q, request)
      error = estimate_of(row, m, s, q, request, all_own=.true.)
      if (.not. s%taken .or. is_fixed(m, request)) return
      solved = row_of(m, s%solved, request)
      where (error < nothing_known) error = error + difference(row, solved)
      if (request%kind >= request_pole) error = merge(nothing_known, error, lost_numbers(row, solved))
   end function row_error

   !> The largest error (0:2) of a position, velocity and acceleration in any row of a link, point or pair;
   !> `nothing_known`, where it is so. In parts of the characteristic `length` and `rate`.
   pure function largest_errors(m, s, q, length, rate) result(largest)
      type(mechanism_t), intent(in) :: m
      type(error_estimate_t), intent(in) :: s
      type(motion_t), intent(in) :: q
      real(wp), intent(in) :: length, rate
      real(wp) :: largest(0:2), error(3, 0:2), unit(3)
      type(row_t) :: row
      integer :: i, k

      largest = 0.0_wp
      do i = 1, size(m%requests)
         if (m%requests(i)%kind >= request_pole) cycle
         error = row_error(m, s, q, m%requests(i))
         unit = [length, length, 1.0_wp]
         row = row_of(m, q, m%requests(i))
         if (row%angular) unit(1) = 1.0_wp
         do k = 0, 2
            if (any(error(:, k) >= nothing_known)) then
               largest(k) = nothing_known
            else
               largest(k) = max(largest(k), maxval(error(:, k)/(unit*rate**k)))
            end if
         end do
      end do
   end function largest_errors
end module error_estimate
