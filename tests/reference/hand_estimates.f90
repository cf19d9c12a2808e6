!> Tests. What rounding leaves open of the numbers of a deck next to a dead point, as the manual defines it: by how much
!> its closed form in real128 changes where all numbers of its cards are off by 256 roundings, up or down, eight times,
!> by a generator of signs that is written down here again. The derivatives of the closed form by each number say the
!> same of errors in proportion.
module hand_estimates
   use, intrinsic :: iso_fortran_env, only: int64, real64
   use mechanism, only: mechanism_t, pair_prismatic
   use quad_jet, only: qp
   use closed_forms_hard, only: pushed_slider
   use hand_rows, only: hand_row_t, row_by_hand
   use hand_scales, only: length_by_hand
   implicit none
   private
   public :: estimates_by_hand, linear_estimates

   integer, parameter :: sample_count = 8
   !> Of so few samples the largest may be too small; a sum is off by so many roundings of its largest number.
   real(qp), parameter :: caution = 2.5_qp, sum_roundings = 1.5_qp
   real(qp), parameter :: rounding = real(epsilon(1.0_real64), qp)
   !> By so many roundings each number is off.
   real(qp), parameter :: roundings = 256.0_qp
   !> Small beside the distance from the dead point, large beside a rounding of real128.
   real(qp), parameter :: difference = 1.0e-19_qp

   !> The numbers of `pushed_slider`: the pin of the crank and the eye of the rod in their links' axes, the direction of
   !> the guide, the piston's value, rate and acceleration at t = 0, and the instant.
   integer, parameter :: number_count = 9

   !> Park and Miller's generator of signs.
   integer(int64), parameter :: multiplier = 16807, modulus = 2147483647, seed = 198709

contains

   !> The errors (3, 0:2, requests) at `t` of the piston-driven slider `m`.
   function estimates_by_hand(m, t) result(error)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: t
      real(qp), dimension(3, 0:2, size(m%requests)) :: error, middle
      real(qp) :: numbers(number_count), sizes(number_count)
      integer :: k

      call take_numbers(m, t, numbers, sizes)
      middle = rows_of(m, numbers)
      error = 0.0_qp
      do k = 1, sample_count
         error = max(error, abs(rows_of(m, numbers + roundings*rounding*sizes*signs_of(m, k)) - middle))
      end do
      error = with_sums(m, middle, error/roundings)
   end function estimates_by_hand

   !> The same by the derivatives of the closed form, number by number of the deck.
   function linear_estimates(m, t) result(error)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: t
      real(qp), dimension(3, 0:2, size(m%requests)) :: error, change
      real(qp) :: slope(3, 0:2, size(m%requests), number_count), numbers(number_count), sizes(number_count), &
         step(number_count), signs(number_count)
      integer :: i, k

      call take_numbers(m, t, numbers, sizes)
      do i = 1, number_count
         step = 0.0_qp
         step(i) = difference
         slope(:, :, :, i) = (rows_of(m, numbers + step) - rows_of(m, numbers - step))/(2.0_qp*difference)
      end do
      error = 0.0_qp
      do k = 1, sample_count
         signs = signs_of(m, k)
         change = 0.0_qp
         do i = 1, number_count
            change = change + slope(:, :, :, i)*(signs(i)*rounding*sizes(i))
         end do
         error = max(error, abs(change))
      end do
      error = with_sums(m, rows_of(m, numbers), error)
   end function linear_estimates

   !> The estimate for changes of one rounding (`change`) of the rows `value` (both: 3, 0:2, requests). What stands
   !> still is known without a sum.
   function with_sums(m, value, change) result(error)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: value(:, :, :), change(:, :, :)
      real(qp) :: error(3, 0:2, size(m%requests))

      error = merge(0.0_qp, caution*change + sum_errors(m, value), &
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
      sizes(5) = max(1.0_qp, sizes(5))
   end subroutine take_numbers

   !> The rows (3, 0:2, requests) with other `numbers` of the deck.
   function rows_of(m, numbers) result(value)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: numbers(number_count)
      real(qp) :: value(3, 0:2, size(m%requests))
      type(hand_row_t) :: row
      integer :: i

      do i = 1, size(m%requests)
         row = row_by_hand(m, pushed_slider(numbers), m%requests(i))
         value(:, :, i) = row%value
      end do
   end function rows_of

   !> The signs of sample `k`. Each number of a card takes the generator on: three of a GROUND, two of a POINT, three of
   !> a PRISM, three of a DRIVE card. In every second sample all cards of a kind begin at the same place.
   function signs_of(m, k) result(sign_of)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k
      real(qp) :: sign_of(number_count), drawn(3)
      integer(int64) :: state
      integer :: i

      state = seed*k
      do i = 1, count(m%links%ground)
         call draw(1, drawn)
      end do
      do i = 1, size(m%points)
         call draw(2, drawn(:2))
         if (m%points(i)%name == 'PIN-CR') sign_of(1:2) = drawn(:2)
         if (m%points(i)%name == 'EYE') sign_of(3:4) = drawn(:2)
      end do
      call draw(3, drawn)
      sign_of(5) = drawn(1)
      call draw(4, sign_of(6:8))
      sign_of(9) = merge(1.0_qp, -1.0_qp, mod(k, 4) >= 2)

   contains

      !> The signs of a card of kind number `kind`.
      subroutine draw(kind, drawn)
         integer, intent(in) :: kind
         real(qp), intent(out) :: drawn(:)
         integer :: j

         if (mod(k, 2) == 0) state = mod(multiplier*(seed*k + seed*kind), modulus)
         do j = 1, size(drawn)
            state = mod(multiplier*state, modulus)
            drawn(j) = merge(1.0_qp, -1.0_qp, 2*state > modulus)
         end do
      end subroutine draw
   end function signs_of

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
end module hand_estimates
