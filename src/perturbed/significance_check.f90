!> The largest amplification of roundings in a motion, which tells whether digits of the tables may be lost. It is found
!> at every instant that is printed, and must cost little.
module significance_check
   use, intrinsic :: iso_fortran_env, only: real64
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_newton, measure_count
   use motion, only: motion_t
   use drives, only: growing_sizes
   use scales, only: characteristic_length, characteristic_rate, is_length, latest_time
   use columns, only: kinds_of_rows
   use points, only: amplification_in_rows
   use blocks, only: blocks_t, geometry_t
   use block_state, only: state_t
   implicit none
   private
   public :: sizes_t, sizes_of, find_amplification, max_amplification

   !> Tables have equal digits in every kind of real: a kind that is coarser than real64 allows this part of the
   !> roundings.
   real(wp), parameter :: part_of_real64 = min(1.0_wp, real(epsilon(1.0_real64), wp)/epsilon(1.0_wp))
   !> Errors are roundings times |J^-1|^2 times the Lipschitz constant of J times the requested number. Below this many
   !> roundings, and with no number above `safe_size` characteristic sizes, all digits of a table are right.
   real(wp), parameter :: max_amplification = 1.0e4_wp*part_of_real64
   !> Numbers above this many characteristic sizes count as amplified without limit.
   real(wp), parameter :: safe_size = 1.0e4_wp
   !> rad: angles up to `usual_angle` count as any number does. Of larger angles only their rounding grows, not the
   !> terms of their motion. An angle times its amplification is safe up to `safe_angle`: a digit of a table is worth
   !> at least 1.7E-8 rad, or 1E-7 of the characteristic rate.
   real(wp), parameter :: usual_angle = 8.0_wp, safe_angle = 1.0e5_wp*part_of_real64

   !> The sizes of a mechanism, with which its numbers are compared.
   type :: sizes_t
      real(wp) :: length = 1.0_wp, rate = 1.0_wp   !< characteristic length and rate in the deck's units
      !> Largest size of the drives' laws at t = 0 (characteristic), and its growth (1 over the unit of time) with |t|.
      real(wp) :: law(0:1) = 0.0_wp
      logical :: has_formulas = .false.        !< it has measures, poles or curves
   end type sizes_t

   !> Smaller pivots of a block count as this: its inverse squared is within the range of reals, and digits are lost.
   real(wp), parameter :: smallest_pivot = epsilon(1.0_wp)**2
   !> A digit of a rate is worth at least so many digits of an angle: 1E-7 over 1.7E-8.
   real(wp), parameter :: rate_digits = 6.0_wp
   !> The vectors that a block gets from earlier blocks may be so many times as large as its own before their roundings
   !> count.
   real(wp), parameter :: usual_coarse = 16.0_wp

contains

   !> Finds the sizes of a mechanism: characteristic length and rate, and the size of the largest law of its drives.
   function sizes_of(m) result(s)
      type(mechanism_t), intent(in) :: m
      type(sizes_t) :: s
      real(wp) :: sizes(3, 0:1)
      integer :: i, k

      s%length = characteristic_length(m)
      s%rate = characteristic_rate(m, s%length)
      s%has_formulas = measure_count(m) > 0 .or. any(kinds_of_rows(m%requests%kind)%is_centre)
      do i = 1, size(m%drives)
         sizes = growing_sizes(m%drives(i), latest_time(m))/merge(s%length, 1.0_wp, is_length(m%drives(i)))
         do k = 1, 3
            s%law = max(s%law, sizes(k, :)/s%rate**(k - 1))
         end do
      end do
   end function sizes_of

   !> Finds the largest amplification of roundings in a motion. Small pivots of blocks amplify them; with a number above
   !> `safe_size` they count as amplified without limit. If rates do not exist, the blocks still have found the position
   !> to the last digits. METHOD DENSE and METHOD MATRIX may always lose digits: all equations have one unit of length
   !> for large links and small ones, and pivots of blocks do not show their errors.
   pure subroutine find_amplification(sizes, m, b, x, s, q, amplification, may_lose_digits)
      type(sizes_t), intent(in) :: sizes     !< of `m`
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(state_t), intent(in) :: s         !< of the motion
      type(motion_t), intent(in) :: q        !< of all links
      real(wp), intent(out) :: amplification   !< factor of a rounding, relative to the characteristic sizes; or huge
      logical, intent(out) :: may_lose_digits       !< digits of the tables may be lost
      real(wp) :: law, angle, size_of, usual, of_angles, inverse
      real(wp) :: largest(2, 0:2)
      integer :: k

      law = sizes%law(0) + sizes%law(1)*abs(q%t)
      amplification = merge(huge(amplification), 0.0_wp, q%known >= 0 .and. m%method /= method_newton)
      may_lose_digits = amplification > 0.0_wp .or. law > safe_angle
      if (q%known < 2 .or. q%rests) return
      amplification = huge(amplification)
      may_lose_digits = .true.

      call find_largest(size(q%position, 2), q%position, q%velocity, q%acceleration, largest)
      angle = max(largest(2, 0), law)
      ! Ground links far from the origin of the deck are rounded in proportion to their distance.
      associate (length => sizes%length, rate => sizes%rate)
         size_of = max(1.0_wp, largest(1, 0)/length, maxval(abs(q%origin))/length, &
            max(largest(1, 1)/length, largest(2, 1))/rate, max(largest(1, 2)/length, largest(2, 2))/rate**2)
      end associate
      if (sizes%has_formulas) size_of = max(size_of, amplification_in_rows(m, q, sizes%rate))
      if (size_of > safe_size) return
      usual = max(size_of, min(angle, usual_angle))

      ! A block has p, the least pivot of its Jacobian (at most 1), L, its Lipschitz constant, and C, its `coarse`.
      ! Roundings of numbers are amplified by L/p^2; with C above `usual_coarse` also by C/p and C L/p^2. Roundings of
      ! angles are amplified by C/p in positions and, over `rate_digits`, by C L^2/p^3 in accelerations.
      amplification = 0.0_wp
      of_angles = 1.0_wp

      do k = 1, size(b%needed)
         associate (block => x%blocks(b%needed(k)))
            if (b%list(b%needed(k))%explicit) cycle
            inverse = 1.0_wp/max(min(1.0_wp, s%jacobian(b%needed(k))%pivot), smallest_pivot)
            associate (turned => block%lipschitz*inverse)
               amplification = max(amplification, turned*inverse)
               if (block%coarse > usual_coarse) amplification = max(amplification, block%coarse*inverse*max(1.0_wp, &
                  turned))
               of_angles = max(of_angles, block%coarse*inverse*max(1.0_wp, turned**2/rate_digits))
            end associate
         end associate
      end do
      amplification = usual*amplification
      may_lose_digits = max(usual, amplification) > max_amplification .or. m%method /= method_newton
      if (.not. angle > usual_angle) return
      may_lose_digits = may_lose_digits .or. angle*size_of*of_angles > safe_angle
      amplification = amplification*max(1.0_wp, angle/usual)
   end subroutine find_amplification

   !> Finds the largest |length| and |angle| in positions, velocities and accelerations. Reason for plain arrays: they
   !> cost no descriptors at each instant.
   pure subroutine find_largest(n, positions, velocities, accelerations, largest)
      integer, intent(in) :: n               !< how many links there are
      real(wp), intent(in), dimension(3, n) :: positions, velocities, accelerations   !< of the links, deck's units, rad
      real(wp), intent(out) :: largest(2, 0:2)   !< length and angle, and their derivatives, in these units
      integer :: i

      largest = 0.0_wp
      do i = 1, n
         largest(:, 0) = max(largest(:, 0), [max(abs(positions(1, i)), abs(positions(2, i))), abs(positions(3, i))])
         largest(:, 1) = max(largest(:, 1), [max(abs(velocities(1, i)), abs(velocities(2, i))), abs(velocities(3, i))])
         largest(:, 2) = max(largest(:, 2), [max(abs(accelerations(1, i)), abs(accelerations(2, i))), &
            abs(accelerations(3, i))])
      end do
   end subroutine find_largest
end module significance_check
