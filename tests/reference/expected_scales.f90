!> Tests. The decimals and powers of ten of the tables of a deck, computed in real128 from the numbers of its cards by
!> the rule of docs/outputs.md: seven digits to the characteristic length and rate. Nothing of the program's layout is
!> used.
module expected_scales
   use mechanism, only: mechanism_t, drive_t, pair_prismatic, drive_angle, drive_relangle, drive_x, drive_y, &
      term_harmonic, term_power, term_table, term_kinds
   use rise_laws, only: peak_rate
   use quad_jet, only: qp, degree_q
   implicit none
   private
   public :: listed_t, listed_set, length_by_hand, rate_by_hand, ratio_of

   !> (dimension, derivative), and those of the time. A dimension is a length (1), an angle (2), or that of a ratio.
   type :: expected_scales_t
      integer :: decimals(6, 0:2) = 0, power(6, 0:2) = 0
      integer :: time_decimals = 0, time_power = 0
   end type expected_scales_t

   !> A set of computations with what all of its tables need.
   type, extends(mechanism_t) :: listed_t
      character(:), allocatable :: name        !< of the deck
      type(expected_scales_t) :: scales
      integer :: language = 1                  !< English (1) or Polish (2)
   end type listed_t

   !> Numbers up to 9999999 and down to 0.001 need no power of ten. (Tolerances with more decimals need one from a
   !> larger number on; no deck of input/ has such a number.)
   integer, parameter :: highest = 6, lowest = -3, digits = 7

contains

   !> The set `m` of the deck `name`.
   function listed_set(name, m) result(listed)
      character(*), intent(in) :: name
      type(mechanism_t), intent(in) :: m
      type(listed_t) :: listed

      listed%mechanism_t = m
      listed%name = name
      listed%scales = scales_of_deck(m)
      listed%language = merge(2, 1, m%polish)
   end function listed_set

   type(expected_scales_t) function scales_of_deck(m) result(s)
      class(mechanism_t), intent(in) :: m
      real(qp) :: length, rate, turn, sizes(2)
      integer :: k, quantity, drive

      length = length_by_hand(m)
      rate = rate_by_hand(m, length)
      do k = 0, 2
         turn = rate**k
         ! Angles themselves are of the order of 1 in either unit.
         if (m%degrees .and. k > 0) turn = turn/degree_q
         call take(length*rate**k, s%decimals(1, k), s%power(1, k))
         call take(turn, s%decimals(2, k), s%power(2, k))
      end do
      call take(last_time(m), s%time_decimals, s%time_power)
      sizes = [length, merge(1.0_qp/degree_q, 1.0_qp, m%degrees)]
      do quantity = 1, 2
         do drive = 1, 2
            associate (d => ratio_of(quantity, drive))
               do k = 0, 1
                  call take(sizes(quantity)/sizes(drive)**(k + 1), s%decimals(d, k), s%power(d, k))
               end do
            end associate
         end do
      end do
   end function scales_of_deck

   !> The dimension of the ratio of a quantity to a drive, each a length (1) or an angle (2).
   pure integer function ratio_of(quantity, drive) result(dimension)
      integer, intent(in) :: quantity, drive

      dimension = 2*quantity + drive
   end function ratio_of

   !> Decimals and power of ten of numbers as large as `x`, by its first digit's place; 1 where it is 0.
   subroutine take(x, decimals, power)
      real(qp), intent(in) :: x
      integer, intent(out) :: decimals, power
      character(60) :: text
      integer :: place

      place = 0
      if (x > 0.0_qp) then
         ! A double of 0.001 may be a little less: so many digits make it 1E-3 again.
         write (text, '(es60.10e4)') x
         read (text(index(text, 'E') + 1:), *) place
      end if
      power = 0
      if (place > highest .or. place < lowest) power = place - modulo(place, 3)
      decimals = digits - 1 - place + power
   end subroutine take

   real(qp) function last_time(m)
      class(mechanism_t), intent(in) :: m
      integer :: i

      last_time = max(abs(real(m%t0, qp)), abs(real(m%t1, qp)))
      do i = 1, size(m%at)
         last_time = max(last_time, abs(real(m%at(i), qp)))
      end do
   end function last_time

   !> The largest side of the boxes round the points of each link and its origin, in the link's axes; of all ground
   !> points, in the axes of the plane; the largest offset of a guide, and length that a drive has at t = 0.
   real(qp) function length_by_hand(m) result(length)
      class(mechanism_t), intent(in) :: m
      real(qp) :: from(2)
      integer :: i, j

      length = 0.0_qp
      do i = 1, size(m%points)
         associate (link => m%links(m%points(i)%link))
            if (.not. link%ground) length = max(length, maxval(abs(real(m%points(i)%offset, qp))))
            do j = 1, i - 1
               if (link%ground .neqv. m%links(m%points(j)%link)%ground) cycle
               if (.not. link%ground .and. m%points(j)%link /= m%points(i)%link) cycle
               length = max(length, maxval(abs(place(m, i) - place(m, j))))
            end do
         end associate
      end do
      do i = 1, size(m%pairs)
         if (m%pairs(i)%kind == pair_prismatic) length = max(length, abs(real(m%pairs(i)%offset, qp)))
      end do
      from = real(m%links(findloc(m%links%ground, .true., dim=1))%position(:2), qp)
      do i = 1, size(m%drives)
         associate (d => m%drives(i))
            if (any(d%kind == [drive_angle, drive_relangle])) cycle
            if (d%kind == drive_x) length = max(length, abs(d%polynomial(1) - from(1)))
            if (d%kind == drive_y) length = max(length, abs(d%polynomial(1) - from(2)))
            if (all(d%kind /= [drive_x, drive_y])) length = max(length, abs(real(d%polynomial(1), qp)))
         end associate
      end do
      if (length <= 0.0_qp) length = 1.0_qp
   end function length_by_hand

   !> Point number `i` in the axes of its link, of a ground link in those of the plane.
   function place(m, i) result(p)
      class(mechanism_t), intent(in) :: m
      integer, intent(in) :: i
      real(qp) :: p(2), phi

      p = real(m%points(i)%offset, qp)
      associate (link => m%links(m%points(i)%link))
         if (.not. link%ground) return
         phi = real(link%position(3), qp)
         p = [cos(phi)*p(1) - sin(phi)*p(2), sin(phi)*p(1) + cos(phi)*p(2)] + real(link%position(:2), qp)
      end associate
   end function place

   !> The largest rate of a drive up to the last instant; of a length, in parts of `length`.
   real(qp) function rate_by_hand(m, length) result(rate)
      class(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: length
      integer :: i

      rate = 0.0_qp
      do i = 1, size(m%drives)
         if (any(m%drives(i)%kind == [drive_angle, drive_relangle])) then
            rate = max(rate, rate_of(m%drives(i), last_time(m)))
         else
            rate = max(rate, rate_of(m%drives(i), last_time(m))/length)
         end if
      end do
      if (rate <= 0.0_qp) rate = 1.0_qp
   end function rate_by_hand

   !> The sum of the largest rates of the terms of drive `d` up to the time `t`.
   real(qp) function rate_of(d, t) result(rate)
      type(drive_t), intent(in) :: d
      real(qp), intent(in) :: t
      integer :: i, k
      real(qp) :: steepest

      rate = abs(real(d%polynomial(2), qp)) + t*abs(real(d%polynomial(3), qp))
      if (.not. allocated(d%terms)) return
      do i = 1, size(d%terms)
         associate (a => d%terms(i))
            steepest = 0.0_qp
            select case (a%kind)
            case (term_harmonic)
               steepest = abs(real(a%r(1), qp)*a%r(2))
            case (term_power)
               steepest = abs(real(a%r(1), qp)*a%r(2))*t**(real(a%r(2), qp) - 1.0_qp)
            case (term_table)
               do k = 2, size(a%table%x)
                  steepest = max(steepest, abs((real(a%table%y(k), qp) - a%table%y(k - 1)) &
                     /(real(a%table%x(k), qp) - a%table%x(k - 1))))
               end do
            case default
               steepest = abs(real(a%r(3), qp)/a%r(2))*peak_rate(trim(term_kinds(a%kind)%word))
            end select
            rate = rate + steepest
         end associate
      end do
   end function rate_of
end module expected_scales
