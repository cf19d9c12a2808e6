!> How far the rows of a table are known: the motion once more, from the deck as it is and from decks whose
!> numbers are a little off.
module error_estimate
   use kinds, only: wp
   use mechanism, only: mechanism_t, request_t, request_point
   use motion, only: motion_t
   use points, only: row_t, row_of, is_fixed
   use known_digits, only: nothing_known
   use perturbed_deck, only: perturbation
   implicit none
   private
   public :: error_estimate_t, unusable, row_estimate, row_error, largest_errors, find_estimates

   !> What the samples differ by is an error of as many roundings as the perturbation is long; a deck's number, and with
   !> it every sum and product, is off by half a rounding. For how few the samples are: some more.
   real(wp), parameter :: roundings = perturbation/epsilon(1.0_wp)
   real(wp), parameter :: caution = 2.5_wp
   real(wp), parameter :: estimate_roundings = 1.5_wp

   !> `known` of a sample that tells nothing: equations that are too many contradict one another once each is off by
   !> itself.
   integer, parameter :: unusable = -2

   !> Motions at one instant; samples(0) is that of the deck itself. They are `taken` where digits of the tables could
   !> be `in_doubt`, which are masked then, or where the errors are `asked` for, if there is a position.
   type :: error_estimate_t
      logical :: taken = .false., asked = .false., in_doubt = .false.
      !> (length or angle, derivative) What a sum of numbers as large as the largest of the rows is rounded by.
      real(wp) :: estimate(2, 0:2) = 0.0_wp
      type(motion_t), allocatable :: samples(:)
   end type error_estimate_t

contains

   !> What rounding of the deck's numbers leaves open in the row that `request` asks for (3, 0:2), in its units: the
   !> conditioning of the mechanism, whatever program has solved it. `nothing_known`, where it is so.
   pure function row_estimate(m, s, request) result(error)
      type(mechanism_t), intent(in) :: m
      type(error_estimate_t), intent(in) :: s
      type(request_t), intent(in) :: request
      real(wp) :: error(3, 0:2), scale
      type(row_t) :: middle, one
      logical :: zero(3, 0:2)
      integer :: k, known

      error = 0.0_wp
      if (is_fixed(m, request)) then
         error(:, 0) = fixed_error(m, request)
         return
      end if
      if (s%asked) error = nothing_known
      if (.not. s%taken) return
      error = 0.0_wp
      middle = row_of(m, s%samples(0), request)
      known = middle%known
      zero = abs(middle%value) <= 0.0_wp
      ! Where the Jacobian has no inverse, a position changes with the root of what the deck changes by.
      scale = caution/merge(roundings, sqrt(roundings), known > 0)
      do k = 1, ubound(s%samples, 1)
         if (s%samples(k)%known == unusable) cycle
         ! Half of the kin of a mechanism at its limit cannot go so far.
         one = row_of(m, s%samples(k), request)
         if (one%known < 0 .and. known == 0) cycle
         error = max(error, abs(one%value - middle%value))
         zero = zero .and. abs(one%value) <= 0.0_wp
         known = min(known, one%known)
      end do
      ! A coordinate of what stands still is zero without a sum.
      error = merge(0.0_wp, scale*error + estimate_of_errors(s, middle%angular), zero)
      error(:, known + 1:) = nothing_known
   end function row_estimate

   !> What rounding leaves open of the place (3) of a ground link or of a point on one: a sum of numbers of cards.
   pure function fixed_error(m, request) result(error)
      type(mechanism_t), intent(in) :: m
      type(request_t), intent(in) :: request
      real(wp) :: error(3)
      type(row_t) :: row

      row = row_of(m, motion_t(), request)
      error = abs(row%value(:, 0))
      if (request%kind == request_point) then
         associate (p => m%points(request%subject))
            error = max(error, norm2(p%offset), norm2(m%links(p%link)%position(:2)))
         end associate
      end if
      error = merge(estimate_roundings*epsilon(1.0_wp)*error, 0.0_wp, abs(row%value(:, 0)) > 0.0_wp)
   end function fixed_error

   !> To be called when `s` has its samples; `length`: the characteristic one. What is summed up to a velocity is no
   !> smaller than an angular velocity times a length, what is summed up to an acceleration has the square of one.
   pure subroutine find_estimates(m, length, s)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: length
      type(error_estimate_t), intent(inout) :: s
      type(row_t) :: row
      real(wp) :: size_of(2, 0:2)
      integer :: i, unit

      size_of = 0.0_wp
      do i = 1, size(m%requests)
         row = row_of(m, s%samples(0), m%requests(i))
         unit = merge(2, 1, row%angular)
         size_of(unit, :) = max(size_of(unit, :), maxval(abs(row%value(:2, :)), dim=1))
         size_of(2, :) = max(size_of(2, :), abs(row%value(3, :)))
      end do
      size_of(2, 0) = max(size_of(2, 0), 1.0_wp)
      size_of(1, 0) = max(size_of(1, 0), size_of(2, 0)*length)
      size_of(1, 1) = max(size_of(1, 1), size_of(2, 1)*length)
      size_of(:, 2) = max(size_of(:, 2), size_of(:, 1)*size_of(2, 1))
      s%estimate = estimate_roundings*epsilon(1.0_wp)*size_of
   end subroutine find_estimates

   !> The noise of a row (3, 0:2); `angular`: of a pair whose value is an angle.
   pure function estimate_of_errors(s, angular) result(estimate)
      type(error_estimate_t), intent(in) :: s
      logical, intent(in) :: angular
      real(wp) :: estimate(3, 0:2)

      estimate = s%estimate([1, 1, 2], :)
      if (angular) estimate(1, :) = s%estimate(2, :)
   end function estimate_of_errors

   !> The error of the row of `q`, estimated: the scatter, and how far it is from the
   !> motion solved to the limit of rounding.
   pure function row_error(m, s, q, request) result(error)
      type(mechanism_t), intent(in) :: m
      type(error_estimate_t), intent(in) :: s
      type(motion_t), intent(in) :: q
      type(request_t), intent(in) :: request
      real(wp) :: error(3, 0:2)
      type(row_t) :: row, solved

      error = row_estimate(m, s, request)
      if (.not. s%taken .or. is_fixed(m, request)) return
      row = row_of(m, q, request)
      solved = row_of(m, s%samples(0), request)
      where (error < nothing_known) error = error + abs(row%value - solved%value)
   end function row_error

   !> The largest error (0:2) of a position, velocity and acceleration in any row; `nothing_known`, where it is so.
   !> In parts of the characteristic `length` and `rate`.
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
