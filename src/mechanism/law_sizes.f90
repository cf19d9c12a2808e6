!> How large the numbers are that are added up to the law of a drive: its value and its rates may be small differences
!> of large ones, and are known by so many fewer digits.
module law_sizes
   use kinds, only: wp
   use mechanism, only: term_harmonic, term_power, term_table
   use drives, only: law_t, monomial
   use splines, only: spline_t
   implicit none
   private
   public :: growing_sizes

   !> The largest derivatives 0 to 3 of a rise of the lift 1 and the duration 1, whatever its law.
   real(wp), parameter :: rise_most(0:3) = [1.0_wp, 2.0_wp, 6.3_wp, 60.0_wp]

contains

   !> Bounds, as (:, 0) + |t| (:, 1), of what a change of each number of `law`, or of the time, changes of value, rate
   !> and acceleration (3) at each time t from -`last` to `last`, over the relative change; in the drive's unit (length
   !> or rad) and the deck's unit of time. Of a power with a negative exponent at the time `last` alone: before, the law
   !> itself is as large.
   pure function growing_sizes(law, last) result(sizes)
      type(law_t), intent(in) :: law
      real(wp), intent(in) :: last
      real(wp) :: sizes(3, 0:1)

      sizes(:, 0) = sizes_at(law, 0.0_wp, last)
      sizes(:, 1) = (sizes_at(law, last, last) - sizes(:, 0))/merge(last, 1.0_wp, last > 0.0_wp)
   end function growing_sizes

   !> The sizes (3) at the times -`t` and `t`. Between t = 0 and `last` none of them is above its chord.
   pure function sizes_at(law, t, last) result(sizes)
      type(law_t), intent(in) :: law
      real(wp), intent(in) :: t, last
      real(wp) :: sizes(3)
      integer :: i

      associate (c => abs(law%drive%polynomial))
         sizes = [c(1) + t*(c(2) + t*c(3)), c(2) + t*c(3), c(3)]
      end associate
      do i = 1, size(law%drive%terms)
         associate (term => law%drive%terms(i), r => abs(law%drive%terms(i)%r))
            select case (term%kind)
            case (term_harmonic)
               sizes = sizes + (1.0_wp + r(2)*t + r(3))*r(1)*[1.0_wp, r(2), r(2)**2]
            case (term_power)
               sizes = sizes + (1.0_wp + r(2))*[power_size(r(1), term%r(2), t, last), &
                  power_size(r(1)*r(2), term%r(2) - 1.0_wp, t, last), &
                  power_size(r(1)*r(2)*abs(term%r(2) - 1.0_wp), term%r(2) - 2.0_wp, t, last)]
            case (term_table)
               sizes = sizes + table_sizes(law%splines(i), t)
            case default
               ! Beyond its end the time changes nothing.
               sizes = sizes + r(3)*(rise_most(:2) + (2.0_wp*r(1)/r(2) + 1.0_wp)*rise_most(1:))/[1.0_wp, r(2), r(2)**2]
            end select
         end associate
      end do
   end function sizes_at

   !> Of c t**p, c >= 0: its value, or that at the time `last` where it grows more slowly than the time.
   pure real(wp) function power_size(c, p, t, last) result(size_of)
      real(wp), intent(in) :: c, p, t, last
      real(wp) :: time

      time = merge(t, last, p >= 1.0_wp)
      size_of = 0.0_wp
      if (time > 0.0_wp) size_of = monomial(c, p, time)
   end function power_size

   !> The sizes of the spline `s`, from the differences of its rows.
   pure function table_sizes(s, t) result(sizes)
      type(spline_t), intent(in) :: s
      real(wp), intent(in) :: t
      real(wp) :: sizes(3), h(size(s%x) - 1), bend, slope

      h = s%x(2:) - s%x(:size(h))
      bend = maxval(abs(s%m))
      slope = maxval(abs(s%y(2:) - s%y(:size(h)))/h) + bend*maxval(h)
      sizes = [maxval(abs(s%y)) + t*slope, slope + t*bend, bend + t*maxval(abs(s%m(2:) - s%m(:size(h)))/h)]
   end function table_sizes
end module law_sizes
