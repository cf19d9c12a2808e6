!> Tests. The closure equations once more, in real128 and complex numbers (the plane as the complex plane, a link's
!> turn as a factor exp(i phi)), and their derivatives as differences. The order of the equations is the program's: two
!> of every pair, (7), (8) or (9), (10), then one of every drive.
module quad_closure
   use kinds, only: wp
   use quad_jet, only: qp
   use mechanism, only: mechanism_t, pair_revolute, drive_angle, drive_x, drive_y, drive_relangle, drive_slide
   implicit none
   private
   public :: closure, closure_slopes, closure_second, positions

contains

   !> Residuals of all equations at the positions `q` (3, links) with the drives at `driven` (drives).
   function closure(m, q, driven) result(r)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: q(:, :), driven(:)
      real(qp) :: r(2*size(m%pairs) + size(m%drives))
      complex(qp) :: gap
      integer :: k

      do k = 1, size(m%pairs)
         associate (pair => m%pairs(k))
            associate (i => m%points(pair%point_i)%link, j => m%points(pair%point_j)%link)
               gap = place(m, q, pair%point_i) - place(m, q, pair%point_j)
               if (pair%kind == pair_revolute) then
                  r(2*k - 1:2*k) = [real(gap, qp), aimag(gap)]
               else
                  ! In the guide's axes: the gap along it and across it.
                  gap = gap*turn(-q(3, i) - real(pair%alpha, qp))
                  r(2*k - 1) = aimag(gap) - real(pair%offset, qp)
                  r(2*k) = q(3, j) - q(3, i) - real(pair%beta, qp)
               end if
            end associate
         end associate
      end do
      do k = 1, size(m%drives)
         r(2*size(m%pairs) + k) = driven_quantity(m, q, k) - driven(k)
      end do
   end function closure

   function driven_quantity(m, q, k) result(value)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: q(:, :)
      integer, intent(in) :: k
      real(qp) :: value

      value = 0.0_qp
      associate (subject => m%drives(k)%subject)
         select case (m%drives(k)%kind)
         case (drive_angle)
            value = q(3, subject)
         case (drive_x)
            value = real(place(m, q, subject), qp)
         case (drive_y)
            value = aimag(place(m, q, subject))
         case (drive_relangle)
            value = q(3, m%drives(k)%second) - q(3, subject)
         case (drive_slide)
            associate (pair => m%pairs(subject))
               value = real((place(m, q, pair%point_j) - place(m, q, pair%point_i)) &
                  *turn(-q(3, m%points(pair%point_i)%link) - real(pair%alpha, qp)), qp)
            end associate
         end select
      end associate
   end function driven_quantity

   !> Derivatives of the residuals by x, y, phi of every moving link, in order. Step 1e-10: h^2 and eps/h are below
   !> 1e-19.
   function closure_slopes(m, q) result(slopes)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: q(:, :)
      real(qp) :: slopes(2*size(m%pairs) + size(m%drives), 3*count(.not. m%links%ground))
      real(qp) :: there(3, size(q, 2)), back(3, size(q, 2)), still(size(m%drives))
      real(qp), parameter :: h = 1.0e-10_qp
      integer :: link, i, column

      still = 0.0_qp
      column = 0
      do link = 1, size(m%links)
         if (m%links(link)%ground) cycle
         do i = 1, 3
            column = column + 1
            there = q
            back = q
            there(i, link) = q(i, link) + h
            back(i, link) = q(i, link) - h
            slopes(:, column) = (closure(m, there, still) - closure(m, back, still))/(2.0_qp*h)
         end do
      end do
   end function closure_slopes

   !> Second derivative by time of the residuals on the way q + v t + a t^2/2, the drives standing still.
   !> Step 1e-8: h^2 and eps/h^2 are below 1e-16.
   function closure_second(m, q, v, a) result(second)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: q(:, :), v(:, :), a(:, :)
      real(qp) :: second(2*size(m%pairs) + size(m%drives)), still(size(m%drives))
      real(qp), parameter :: h = 1.0e-8_qp

      still = 0.0_qp
      second = (closure(m, q + h*(v + 0.5_qp*h*a), still) - 2.0_qp*closure(m, q, still) &
         + closure(m, q - h*(v - 0.5_qp*h*a), still))/h**2
   end function closure_second

   !> The rough positions (3, links) of all links.
   function positions(m) result(q)
      type(mechanism_t), intent(in) :: m
      real(wp) :: q(3, size(m%links))
      integer :: i

      do i = 1, size(m%links)
         q(:, i) = m%links(i)%position
      end do
   end function positions

   pure complex(qp) function place(m, q, i)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: q(:, :)
      integer, intent(in) :: i

      associate (link => m%points(i)%link, offset => real(m%points(i)%offset, qp))
         place = cmplx(q(1, link), q(2, link), qp) + cmplx(offset(1), offset(2), qp)*turn(q(3, link))
      end associate
   end function place

   pure complex(qp) function turn(phi)
      real(qp), intent(in) :: phi

      turn = cmplx(cos(phi), sin(phi), qp)
   end function turn
end module quad_closure
