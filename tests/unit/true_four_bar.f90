!> Tests. The motion of the sample four-bar in real128, from its own two equations.
module true_four_bar
   use kinds, only: wp
   use quad_jet, only: qp
   use mechanism, only: mechanism_t
   implicit none
   private
   public :: true_motion

contains

   !> Angles, rates and accelerations (0:2, 2) of coupler and rocker of `m` at `t`, by Newton's method from `start` (2).
   function true_motion(m, t, start) result(x)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: t
      real(wp), intent(in) :: start(2)
      real(qp) :: x(0:2, 2), crank(0:2), r(3)
      integer :: k

      r = [m%points(4)%offset(1), m%points(6)%offset(1), m%points(8)%offset(1)]
      crank = [m%drives(1)%polynomial(1) + t*m%drives(1)%polynomial(2), real(m%drives(1)%polynomial(2), qp), 0.0_qp]
      x(0, :) = start
      do k = 1, 12
         x(0, :) = x(0, :) - solved(r(1)*[cos(crank(0)), sin(crank(0))] + r(2)*[cos(x(0, 1)), sin(x(0, 1))] &
            - r(3)*[cos(x(0, 2)), sin(x(0, 2))] - [real(m%points(2)%offset(1), qp), 0.0_qp])
      end do
      x(1, :) = -solved(r(1)*crank(1)*[-sin(crank(0)), cos(crank(0))])
      x(2, :) = solved(r(1)*crank(1)**2*[cos(crank(0)), sin(crank(0))] + r(2)*x(1, 1)**2*[cos(x(0, 1)), sin(x(0, 1))] &
         - r(3)*x(1, 2)**2*[cos(x(0, 2)), sin(x(0, 2))])

   contains

      !> J^-1 `f`.
      function solved(f) result(d)
         real(qp), intent(in) :: f(2)
         real(qp) :: d(2), a(2, 2)

         a(:, 1) = r(2)*[-sin(x(0, 1)), cos(x(0, 1))]
         a(:, 2) = -r(3)*[-sin(x(0, 2)), cos(x(0, 2))]
         d = [a(2, 2)*f(1) - a(1, 2)*f(2), a(1, 1)*f(2) - a(2, 1)*f(1)]/(a(1, 1)*a(2, 2) - a(1, 2)*a(2, 1))
      end function solved
   end function true_motion
end module true_four_bar
