!> What the roundings of sums leave open of rows, and how they grow in instant centres and centres of curvature.
module sum_errors
   use kinds, only: wp
   use mechanism, only: mechanism_t, request_t, request_point, request_pair, request_pole, request_curve
   use known_digits, only: nothing_known
   use motion, only: motion_t, known_of
   use points, only: row_t, find_row
   use instant_centres, only: centre_finite, centre_starting
   implicit none
   private
   public :: errors_of_sums, error_of_sums, fixed_error, lost_numbers, growth_in_centres

   !> A sum is off by so many roundings of its largest number.
   real(wp), parameter :: sum_roundings = 1.5_wp

contains

   !> The rounding errors (length, angle or slide, derivative) of sums of numbers as large as the largest of the links
   !> of the motion `q` of `m` and its `rows`, but for poles; `length`: the characteristic one. What is summed up to a
   !> velocity is no smaller than an angular velocity times a length, what is summed up to an acceleration has the
   !> square of one. A slide is a difference of places, which are counted from a ground link, and so are the arms of its
   !> derivatives.
   pure function errors_of_sums(m, q, length, rows) result(size_of)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      real(wp), intent(in) :: length
      type(row_t), intent(in) :: rows(:)
      real(wp) :: size_of(3, 0:2)
      real(wp) :: reach
      integer :: i

      size_of = 0.0_wp
      size_of(1, 0) = maxval(abs(q%origin))
      do i = 1, size(q%position, 2)
         if (known_of(q, i) < 0) cycle
         associate (p => q%position(:, i), v => q%velocity(:, i), a => q%acceleration(:, i))
            size_of(1, :) = max(size_of(1, :), [maxval(abs(p(:2) + q%origin)), maxval(abs(v(:2))), maxval(abs(a(:2)))])
            size_of(2, :) = max(size_of(2, :), abs([p(3), v(3), a(3)]))
            size_of(3, 0) = max(size_of(3, 0), maxval(abs(p(:2))))
         end associate
      end do
      do i = 1, size(rows)
         if (rows(i)%known < 0 .or. rows(i)%kind == request_pole) cycle
         if (rows(i)%kind == request_curve) then
            ! A bound of what its point adds up, which needs no direction.
            associate (point => m%points(m%requests(i)%subject))
               reach = norm2(point%offset)
               size_of(1, :) = max(size_of(1, :), [maxval(abs(q%position(:2, point%link) + q%origin)) + reach, &
                  maxval(abs(q%velocity(:2, point%link))) + abs(q%velocity(3, point%link))*reach, &
                  maxval(abs(q%acceleration(:2, point%link))) + (abs(q%acceleration(3, point%link)) &
                  + q%velocity(3, point%link)**2)*reach])
            end associate
            cycle
         end if
         associate (value => abs(rows(i)%value), unit => merge(2, 1, rows(i)%angular))
            size_of(unit, :) = max(size_of(unit, :), value(1, :))
            if (rows(i)%kind /= request_pair) size_of(:2, :) = max(size_of(:2, :), value(2:, :))
         end associate
      end do
      associate (x => size_of)
         x(2, 0) = max(x(2, 0), 1.0_wp)
         x(1, :1) = max(x(1, :1), x(2, :1)*length)
         x(:2, 2) = max(x(:2, 2), x(:2, 1)*x(2, 1))
         x(3, 0) = max(x(3, 0), x(1, 0))
         x(3, 1:) = max(x(1, 1:), x(3, 0)*x(2, 1:))
         x = sum_roundings*epsilon(1.0_wp)*x
      end associate
   end function errors_of_sums

   !> The rounding errors (3, 0:2) of the sums of `row`, which `request` asks for. `of_sums`: as above.
   pure function error_of_sums(of_sums, request, row) result(estimate)
      real(wp), intent(in) :: of_sums(3, 0:2)
      type(request_t), intent(in) :: request
      type(row_t), intent(in) :: row
      real(wp) :: estimate(3, 0:2)

      if (request%kind >= request_pole) then
         estimate = error_of_centre(of_sums, request, row)
         return
      end if
      estimate = of_sums([1, 1, 2], :)
      if (row%kind == request_pair) estimate(1, :) = of_sums(merge(2, 3, row%angular), :)
   end function error_of_sums

   !> Bounds what rounding leaves open of the place (3) of a ground link or of a point on one: a sum of numbers of
   !> cards.
   pure function fixed_error(m, request) result(error)
      type(mechanism_t), intent(in) :: m
      type(request_t), intent(in) :: request
      real(wp) :: error(3)
      type(row_t) :: row

      call find_row(m, motion_t(), request, row)
      error = abs(row%value(:, 0))
      if (request%kind == request_point) then
         associate (p => m%points(request%subject))
            error = max(error, norm2(p%offset), norm2(m%links(p%link)%position(:2)))
         end associate
      end if
      error = merge(sum_roundings*epsilon(1.0_wp)*error, 0.0_wp, abs(row%value(:, 0)) > 0.0_wp)
   end function fixed_error

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

   !> Bounds what sums leave open of the pole or curve `row` (3, 0:2), through the relative velocity u and its
   !> angular velocity w, or through v and v x a. `of_sums`: as above.
   pure function error_of_centre(of_sums, request, row) result(error)
      real(wp), intent(in) :: of_sums(3, 0:2)
      type(request_t), intent(in) :: request
      type(row_t), intent(in) :: row
      real(wp) :: error(3, 0:2), arm, v, a

      error = 0.0_wp
      if (request%kind == request_pole) then
         if (row%state >= centre_starting) return
         arm = norm2(row%value(:2, 2))
         ! A centre in the origin of link J has no direction there.
         error(3, :) = nothing_known
         if (arm*abs(row%weight) > of_sums(1, 1)) error(3, :) = of_sums(1, 1)/(arm*abs(row%weight)) + of_sums(2, 0)
         if (row%state == centre_finite) &
            error(:2, :) = (of_sums(1, 1) + arm*of_sums(2, 1))/abs(row%weight) + of_sums(1, 0)
         return
      end if
      v = of_sums(1, 1)/(request%length*request%rate)
      a = of_sums(1, 2)/(request%length*request%rate**2)
      error(:2, 0) = of_sums(1, 0)
      error(3, 0) = of_sums(2, 0)
      associate (speed => row%value(3, 1), acceleration => row%value(3, 2))
         if (row%state < centre_starting) error(3, 0) = error(3, 0) + v/speed
         if (row%state == centre_starting) error(3, 0) = error(3, 0) + a/acceleration
         if (row%state /= centre_finite) return
         error(1, 2) = row%value(1, 2)*(3.0_wp*v/speed + (speed*a + acceleration*v)/abs(row%weight))
         error(:2, 1) = error(1, 2) + of_sums(1, 0)
      end associate
   end function error_of_centre

   !> By how much roundings of the motion `q` grow in the poles and curves of `m`, in characteristic ones; at infinity
   !> and at rest without limit.
   pure real(wp) function growth_in_centres(m, q) result(growth)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(row_t) :: row
      integer :: i

      growth = 0.0_wp
      do i = 1, size(m%requests)
         if (m%requests(i)%kind < request_pole) cycle
         call find_row(m, q, m%requests(i), row)
         if (row%state /= centre_finite) growth = huge(1.0_wp)
         if (row%state /= centre_finite) return
         associate (length => m%requests(i)%length, v => row%value(3, 1), a => row%value(3, 2))
            if (m%requests(i)%kind == request_pole) then
               growth = max(growth, (1.0_wp + norm2(row%value(:2, 2))/length)*m%requests(i)%rate/abs(row%weight))
            else
               growth = max(growth, (1.0_wp + row%value(1, 2)/length)*(3.0_wp/v + (v + a)/abs(row%weight)))
            end if
         end associate
      end do
   end function growth_in_centres
end module sum_errors
