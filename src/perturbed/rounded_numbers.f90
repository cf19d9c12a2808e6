!> The roundings of the numbers of a deck, as directions in which all of them are off at once: each by a normal deviate
!> times eps times its size. The deviates are a hash of the number's address: they are equal in millimetres and in
!> kilometres, at any instant, and in any process.
!>
!> The largest change of a row in these directions is multiplied by a factor. To first order the error of a row is a sum
!> over many numbers. Its change in a direction is a sum of normal deviates, and therefore normal for any mechanism; its
!> standard deviation is s. A real x rounded to nearest is off by eps x times a deviate. The variance of that deviate is
!> the mean of 1/(12 m**2) over mantissas m = 1 to 2, 0.045, if small mantissas are as frequent as in random numbers.
!> A vector of length L that turns is rounded four times: on its card, in the sine and cosine, in their products, and in
!> the sum of two of these. Each leaves 0.045 (eps L)**2 in both components together; the directions have 2 (eps L)**2.
!> Therefore the standard deviation of the error is s sqrt(4*0.045/2) = 0.30 s.
!> Of eight normal deviates the largest is below a ninth one over r in one of a million cases if r = 7.84; for sixteen
!> directions r would be 4.07. The factor is 7.84*0.30 = 2.35.
!>
!> An error that is printed has more directions, since nothing else brings it nearer to the true error. By Student's t a
!> deviate exceeds 6.93 times the root of the mean square of 20 others in one case of a million. Here numbers are off by
!> one rounding, and a change holds the calculation's own roundings twice: its variance is (1 + 2*0.09) s**2, and the
!> factor 6.93*0.30/1.09 = 1.91. The error by the calculation only has the factor 6.93/sqrt(2) = 4.90.
module rounded_numbers
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   use plane_vectors, only: pi
   use mechanism, only: mechanism_t, parameter_t, term_t, plane_origin, has_guide, term_kinds, &
      drive_relangle, parameter_link, parameter_point, parameter_pair, parameter_drive, parameter_time
   use parameters, only: parameter_value, set_parameter, set_table
   use motion, only: motion_t, known_of
   use spanning_tree, only: spanning_tree_t, axes_t
   implicit none
   private
   public :: directions, own_directions, safety_factor, own_safety_factor, calculation_safety_factor, &
      perturb_numbers, perturb_sums

   !> How many directions there are for tables, and for errors that are printed. The module's head derives all factors.
   integer, parameter :: directions = 8, own_directions = 20
   !> Factors: of the largest change in `directions`; of the root of the mean square in `own_directions`; of the part of
   !> this root that comes from the calculation only.
   real(wp), parameter :: safety_factor = 2.35_wp, own_safety_factor = 1.91_wp, calculation_safety_factor = 4.90_wp

   !> The hash: numbers modulo a prime, multiplied as in Park and Miller's generator.
   integer(int64), parameter :: multiplier = 16807_int64, modulus = 2147483647_int64
   !> Guides are parallel, or at right angles, if their directions in such parts of a quarter turn are whole quarters.
   integer, parameter :: parts_of_quarter = 2**20

contains

   !> Gives a mechanism the numbers of another mechanism, each off by roundings in a direction. These numbers stay as
   !> they stand: the time of a table, the exponent of a power, the angles of ground links, BETA of guides, and the
   !> initial guess of moving links; with a `length` above 0 also drives and the time.
   subroutine perturb_numbers(m, tree, axes, k, roundings, length, off, time_off)
      type(mechanism_t), intent(in) :: m     !< with the numbers as they stand
      type(spanning_tree_t), intent(in) :: tree   !< of `m`
      type(axes_t), intent(in) :: axes       !< of `m`
      integer, intent(in) :: k               !< the direction; 0: no number is off
      real(wp), intent(in) :: roundings      !< how many roundings; below 0: in the opposite direction
      real(wp), intent(in) :: length         !< size that counts for all lengths, deck's unit; 0: each its own
      type(mechanism_t), intent(inout) :: off   !< with the links, points, pairs and drives of `m`; gets the numbers
      real(wp), intent(out) :: time_off      !< the instant is off by this part of its time
      real(wp) :: origin(2), size_of, largest
      integer :: i, j, quarters

      ! With numbers that are off the closure error of redundant equations exceeds the tolerance.
      if (m%closing > 0.0_wp) off%closing = huge(1.0_wp)
      time_off = 0.0_wp
      if (k > 0 .and. .not. length > 0.0_wp) &
         time_off = roundings*epsilon(1.0_wp)*deviate(parameter_t(parameter_time, 0, 0, 0), k)

      do i = 1, size(m%links)
         if (.not. m%links(i)%ground) cycle
         do j = 1, 2
            call put(parameter_t(parameter_link, i, 0, j), merge(length, abs(m%links(i)%position(j)), length > 0.0_wp))
         end do
      end do
      origin = plane_origin(m)
      do i = 1, size(m%points)
         associate (link => m%links(m%points(i)%link))
            ! Along and across, by the length of the vector to the point: the angle that turns it is rounded. A point of
            ! the ground is counted from the origin of the plane.
            size_of = norm2(m%points(i)%offset)
            if (link%ground) size_of = max(size_of, norm2(link%position(:2) - origin))
            if (length > 0.0_wp) size_of = length
         end associate
         call put(parameter_t(parameter_point, i, 0, 1), size_of)
         call put(parameter_t(parameter_point, i, 0, 2), size_of)
      end do

      largest = max(1.0_wp, maxval(abs(m%pairs%alpha)))
      do i = 1, size(m%pairs)
         if (.not. has_guide(m%pairs(i)%kind)) cycle
         call put(parameter_t(parameter_pair, i, 0, 2), merge(length, abs(m%pairs(i)%offset), length > 0.0_wp))
         ! Guides of links that turn as one, parallel or at right angles by the cards, stay parallel or at right angles:
         ! their directions are off by one part of a radian, whatever angles they are sums of. The angles of ground
         ! links and between guides are as they stand: the vectors that they turn are off.
         associate (link => m%points(m%pairs(i)%point_i)%link)
            quarters = int(modulo(nint((axes%angle_offset(link) + m%pairs(i)%alpha)*(2*parts_of_quarter/pi), int64), &
               int(parts_of_quarter, int64)))
            off%pairs(i)%alpha = m%pairs(i)%alpha
            if (k > 0) off%pairs(i)%alpha = m%pairs(i)%alpha + roundings*epsilon(1.0_wp)*largest &
               *deviate(parameter_t(parameter_pair, tree%orientation(link), quarters, 1), k)
         end associate
      end do

      if (length > 0.0_wp) off%drives = m%drives
      if (length > 0.0_wp) return
      do i = 1, size(m%drives)
         do j = 1, 3
            size_of = abs(m%drives(i)%polynomial(j))
            ! An angle from another link is added to the angle of that link, and the sum is rounded.
            if (j == 1 .and. m%drives(i)%kind == drive_relangle) size_of = max(size_of, 1.0_wp)
            call put(parameter_t(parameter_drive, i, 0, j), size_of)
         end do
         if (.not. allocated(m%drives(i)%terms)) cycle
         do j = 1, size(m%drives(i)%terms)
            call perturb_term(m%drives(i)%terms(j), i, j)
         end do
      end do

   contains

      !> Gives a number of `off` its value in `m`, off by roundings of its size. A number of size 0 stays.
      subroutine put(number, size_of)
         type(parameter_t), intent(in) :: number   !< the address of the number
         real(wp), intent(in) :: size_of     !< in the unit of the number, at least 0
         real(wp) :: by

         if (.not. size_of > 0.0_wp) return
         by = 0.0_wp
         if (k > 0) by = roundings*epsilon(1.0_wp)*size_of*deviate(number, k)
         call set_parameter(off, number, parameter_value(m, number) + by)
      end subroutine put

      !> Gives the numbers of a term of `off` their values in `m`, off by roundings. A value of a table is off by the
      !> rounding of its time as well.
      subroutine perturb_term(term, drive, j)
         type(term_t), intent(in) :: term    !< of `m`
         integer, intent(in) :: drive        !< number of its drive
         integer, intent(in) :: j            !< its number among the terms of the drive
         real(wp) :: slope
         integer :: i

         if (term_kinds(term%kind)%has_rows) then
            associate (x => term%table%x, y => term%table%y)
               do i = 1, size(y)
                  slope = 0.0_wp
                  if (i > 1) slope = abs((y(i) - y(i - 1))/(x(i) - x(i - 1)))
                  if (i < size(y)) slope = max(slope, abs((y(i + 1) - y(i))/(x(i + 1) - x(i))))
                  call put(parameter_t(parameter_drive, drive, j, i), abs(y(i)) + abs(x(i))*slope)
               end do
            end associate
            call set_table(off%drives(drive), j)
         else
            do i = 1, term_kinds(term%kind)%inexact
               call put(parameter_t(parameter_drive, drive, j, i), abs(term%r(i)))
            end do
         end if
      end subroutine perturb_term
   end subroutine perturb_numbers

   !> Changes a motion in a direction, by roundings of sums of numbers as large as the largest of its links. The terms
   !> of a velocity are at least an angular velocity times a length; the terms of an acceleration have the square of the
   !> angular velocity. A coordinate that is zero and rests stays zero, but for angles, which may cancel. Links that
   !> turn as one still turn as one.
   subroutine perturb_sums(tree, length, k, roundings, q)
      type(spanning_tree_t), intent(in) :: tree   !< of the mechanism
      real(wp), intent(in) :: length         !< characteristic length, in the deck's unit
      integer, intent(in) :: k               !< the direction
      real(wp), intent(in) :: roundings      !< how many roundings
      type(motion_t), intent(inout) :: q     !< of all links, in the deck's units; links of which nothing is known, too
      real(wp) :: size_of(2, 0:2), x(0:2)
      integer :: i, c, j

      size_of = 0.0_wp
      size_of(1, 0) = maxval(abs(q%origin))
      do i = 1, size(q%position, 2)
         if (known_of(q, i) < 0) cycle
         size_of(1, :) = max(size_of(1, :), [maxval(abs(q%position(:2, i) + q%origin)), &
            maxval(abs(q%velocity(:2, i))), maxval(abs(q%acceleration(:2, i)))])
         size_of(2, :) = max(size_of(2, :), abs([q%position(3, i), q%velocity(3, i), q%acceleration(3, i)]))
      end do
      size_of(2, 0) = max(size_of(2, 0), 1.0_wp)
      size_of(1, :1) = max(size_of(1, :1), size_of(2, :1)*length)
      size_of(:, 2) = max(size_of(:, 2), size_of(:, 1)*size_of(2, 1))
      size_of = roundings*epsilon(1.0_wp)*size_of

      do i = 1, size(q%position, 2)
         do c = 1, 3
            x = [q%position(c, i), q%velocity(c, i), q%acceleration(c, i)]
            if (.not. (any(abs(x) > 0.0_wp) .or. c == 3)) cycle
            do j = 0, 2
               x(j) = x(j) + size_of(merge(2, 1, c == 3), j) &
                  *deviate(parameter_t(parameter_time, merge(tree%orientation(i), i, c == 3 .and. j > 0), c, j + 1), k)
            end do
            q%position(c, i) = x(0)
            q%velocity(c, i) = x(1)
            q%acceleration(c, i) = x(2)
         end do
      end do
   end subroutine perturb_sums

   !> Gives the normal deviate of a number, by its address, in a direction (Box and Muller, Ann. Math. Stat. 29, 1958).
   pure real(wp) function deviate(number, k) result(z)
      type(parameter_t), intent(in) :: number   !< the address
      integer, intent(in) :: k               !< the direction, from 1
      real(wp) :: u, v
      integer(int64) :: x

      x = mixed(mixed(mixed(mixed(0_int64, number%kind), number%subject), number%term), number%place)
      u = real(mixed(x, 2*k - 1), wp)/real(modulus, wp)
      v = real(mixed(x, 2*k), wp)/real(modulus, wp)
      z = sqrt(-2.0_wp*log(u))*cos(2.0_wp*pi*v)
   end function deviate

   !> Mixes two integers to a number from 1 to the modulus less one. The fifth power modulo the prime takes no value
   !> twice.
   pure integer(int64) function mixed(bits, n) result(y)
      integer(int64), intent(in) :: bits     !< from 0 to the modulus less one
      integer, intent(in) :: n               !< at least -1
      integer(int64) :: square

      y = mod(multiplier*bits + n + 1, modulus)
      square = mod(y*y, modulus)
      y = mod(mod(square*square, modulus)*y, modulus)
      y = max(y, 1_int64)
   end function mixed
end module rounded_numbers
