!> Tests. What rounding leaves open of the numbers of a deck next to a dead point, as docs/method.md defines it: by how
!> much its closed form in real128 changes, to first order, where all numbers of its cards are off by roundings times
!> normal deviates, in eight ways, by a hash that is written down here again.
module expected_estimates
   use, intrinsic :: iso_fortran_env, only: int64, real64
   use mechanism, only: mechanism_t, pair_prismatic
   use quad_jet, only: qp, pi_q
   use closed_forms_sliders, only: pushed_slider
   use expected_rows, only: expected_row_t, row_by_hand
   use expected_scales, only: length_by_hand
   implicit none
   private
   public :: estimates_by_hand

   integer, parameter :: directions = 8
   !> Of so few samples the largest may be too small; a sum is off by so many roundings of its largest number.
   real(qp), parameter :: safety_factor = 2.35_qp, sum_roundings = 1.5_qp
   real(qp), parameter :: rounding = real(epsilon(1.0_real64), qp)
   !> Small beside the distance from the dead point, large beside a rounding of real128.
   real(qp), parameter :: difference = 1.0e-19_qp

   !> The numbers of `pushed_slider`: the pin of the crank and the eye of the rod in their links' axes, the direction of
   !> the guide, the piston's value, rate and acceleration at t = 0, and the instant.
   integer, parameter :: number_count = 9

   !> The hash: its multiplier and its modulus, and the kinds of numbers in their addresses. A guide's direction counts
   !> by the orientation of its link, 0 for the ground's, and by what it is beyond quarter turns.
   integer(int64), parameter :: multiplier = 16807, modulus = 2147483647
   integer, parameter :: of_point = 2, of_pair = 4, of_drive = 5, of_time = 7, ground = 0
   real(qp), parameter :: quarter = 2.0_qp**20

contains

   !> The errors (3, 0:2, requests) at `t` of the piston-driven slider `m`, by the derivatives of the closed form.
   function estimates_by_hand(m, t) result(error)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: t
      real(qp), dimension(3, 0:2, size(m%requests)) :: error, change
      real(qp) :: slope(3, 0:2, size(m%requests), number_count), numbers(number_count), sizes(number_count), &
         step(number_count), parts(number_count)
      integer :: i, k

      call take_numbers(m, t, numbers, sizes)
      do i = 1, number_count
         step = 0.0_qp
         step(i) = difference
         slope(:, :, :, i) = (rows_of(m, numbers + step) - rows_of(m, numbers - step))/(2.0_qp*difference)
      end do
      error = 0.0_qp
      do k = 1, directions
         parts = parts_of(m, k)
         change = 0.0_qp
         do i = 1, number_count
            change = change + slope(:, :, :, i)*(parts(i)*rounding*sizes(i))
         end do
         error = max(error, abs(change))
      end do
      error = with_sums(m, rows_of(m, numbers), error)
   end function estimates_by_hand

   !> The estimate for changes of one rounding (`change`) of the rows `value` (both: 3, 0:2, requests). What stands
   !> still is known without a sum.
   function with_sums(m, value, change) result(error)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: value(:, :, :), change(:, :, :)
      real(qp) :: error(3, 0:2, size(m%requests))

      error = merge(0.0_qp, safety_factor*change + sum_errors(m, value), &
         abs(value) <= 0.0_qp .and. change <= 0.0_qp)
   end function with_sums

   !> The numbers of the deck, and the size that a rounding of each goes by: that of an arm for its part across as well,
   !> and that of a radian for a direction.
   subroutine take_numbers(m, t, numbers, sizes)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: t
      real(qp), intent(out) :: numbers(number_count), sizes(number_count)

      numbers(1:2) = real(m%points(findloc(m%points%name == 'PIN-CR', .true., dim=1))%offset, qp)
      numbers(3:4) = real(m%points(findloc(m%points%name == 'EYE', .true., dim=1))%offset, qp)
      numbers(5) = real(m%pairs(findloc(m%pairs%kind, pair_prismatic, dim=1))%alpha, qp)
      numbers(6:8) = real(m%drives(1)%polynomial, qp)
      numbers(9) = t
      sizes = abs(numbers)
      sizes(1:2) = norm2(numbers(1:2))
      sizes(3:4) = norm2(numbers(3:4))
      sizes(5) = 1.0_qp
   end subroutine take_numbers

   !> The rows (3, 0:2, requests) with other `numbers` of the deck.
   function rows_of(m, numbers) result(value)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: numbers(number_count)
      real(qp) :: value(3, 0:2, size(m%requests))
      type(expected_row_t) :: row
      integer :: i

      do i = 1, size(m%requests)
         row = row_by_hand(m, pushed_slider(numbers), m%requests(i))
         value(:, :, i) = row%value
      end do
   end function rows_of

   !> The parts of a rounding by which the numbers are off in direction `k`: normal deviates, each by the address of its
   !> number: kind, card, term of a law, and place on it.
   function parts_of(m, k) result(parts)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k
      real(qp) :: parts(number_count), alpha
      integer :: i

      do i = 1, 2
         parts(i) = deviate(of_point, findloc(m%points%name == 'PIN-CR', .true., dim=1), i)
         parts(2 + i) = deviate(of_point, findloc(m%points%name == 'EYE', .true., dim=1), i)
      end do
      alpha = m%pairs(findloc(m%pairs%kind, pair_prismatic, dim=1))%alpha
      i = modulo(nint(quarter*alpha/(pi_q/2.0_qp)), nint(quarter))
      parts(5) = deviate(of_pair, ground, 1, i)
      parts(6:8) = [(deviate(of_drive, 1, i), i=1, 3)]
      parts(9) = deviate(of_time, 0, 0)

   contains

      !> That of the number at `place` of card number `card` of the `kind`, in its law's `term`.
      real(qp) function deviate(kind, card, place, term)
         integer, intent(in) :: kind, card, place
         integer, intent(in), optional :: term
         integer(int64) :: x
         real(qp) :: u, v

         x = mixed(mixed(0_int64, kind), card)
         if (present(term)) x = mixed(x, term)
         if (.not. present(term)) x = mixed(x, 0)
         x = mixed(x, place)
         u = real(mixed(x, 2*k - 1), qp)/modulus
         v = real(mixed(x, 2*k), qp)/modulus
         deviate = sqrt(-2.0_qp*log(u))*cos(2.0_qp*pi_q*v)
      end function deviate

      !> The fifth power of a number made of `x` and `n`, modulo the prime; 1 for 0.
      integer(int64) function mixed(x, n)
         integer(int64), intent(in) :: x
         integer, intent(in) :: n
         integer(int64) :: base
         integer :: i

         base = mod(multiplier*x + n + 1, modulus)
         mixed = 1
         do i = 1, 5
            mixed = mod(mixed*base, modulus)
         end do
         mixed = max(mixed, 1_int64)
      end function mixed
   end function parts_of

   !> The rounding errors of the sums that rows are made of, as large as the largest number in any of them. A velocity
   !> is a sum of products of a length and an angular velocity, an acceleration of those with the square of one.
   function sum_errors(m, value) result(error)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: value(:, 0:, :)
      real(qp) :: error(3, 0:2, size(m%requests)), lengths(0:2), angles(0:2)
      integer :: k

      do k = 0, 2
         lengths(k) = maxval(abs(value(:2, k, :)))
         angles(k) = maxval(abs(value(3, k, :)))
      end do
      angles(0) = max(angles(0), 1.0_qp)
      lengths(0:1) = max(lengths(0:1), length_by_hand(m)*angles(0:1))
      lengths(2) = max(lengths(2), lengths(1)*angles(1))
      angles(2) = max(angles(2), angles(1)**2)
      error(1, :, :) = spread(sum_roundings*rounding*lengths, 2, size(m%requests))
      error(2, :, :) = error(1, :, :)
      error(3, :, :) = spread(sum_roundings*rounding*angles, 2, size(m%requests))
   end function sum_errors
end module expected_estimates
