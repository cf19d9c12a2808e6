!> Tests. A quantity of time known with its first and second derivative, in real128: Taylor arithmetic.
!> A closed form written with jets yields exact velocities and accelerations without a formula for either.
module quad_jet
   use, intrinsic :: iso_fortran_env, only: real128
   implicit none
   private
   public :: qp, jet_t, pi_q, degree_q, constant_jet, time_jet, wrap_angle
   public :: operator(+), operator(-), operator(*), operator(/)
   public :: sqrt, sin, cos, atan2

   !> With selected_real_kind(18), the extended precision of x86, `make fuzz-mechanisms` takes a third of the time, and
   !> its truth has 18 digits.
   integer, parameter :: qp = real128
   real(qp), parameter :: pi_q = 3.14159265358979323846264338327950288419716939937510_qp
   real(qp), parameter :: degree_q = pi_q/180.0_qp

   type :: jet_t
      real(qp) :: v = 0.0_qp   !< value
      real(qp) :: d = 0.0_qp   !< first derivative by time
      real(qp) :: dd = 0.0_qp  !< second derivative by time
   end type jet_t

   interface operator(+)
      module procedure add_jets, add_real_right, add_real_left
   end interface
   interface operator(-)
      module procedure subtract_jets, subtract_real_right, subtract_real_left, negate
   end interface
   interface operator(*)
      module procedure multiply_jets, multiply_real_right, multiply_real_left
   end interface
   interface operator(/)
      module procedure divide_jets, divide_real_right, divide_real_left
   end interface
   interface sqrt
      module procedure sqrt_jet
   end interface
   interface sin
      module procedure sin_jet
   end interface
   interface cos
      module procedure cos_jet
   end interface
   interface atan2
      module procedure atan2_jets
   end interface

contains

   !> A quantity that does not change.
   elemental type(jet_t) function constant_jet(value)
      real(qp), intent(in) :: value

      constant_jet = jet_t(value, 0.0_qp, 0.0_qp)
   end function constant_jet

   !> Time itself at the instant t.
   elemental type(jet_t) function time_jet(t)
      real(qp), intent(in) :: t

      time_jet = jet_t(t, 1.0_qp, 0.0_qp)
   end function time_jet

   !> An angle less whole turns: half a turn at most.
   elemental real(qp) function wrap_angle(phi)
      real(qp), intent(in) :: phi

      wrap_angle = phi - 2.0_qp*pi_q*anint(phi/(2.0_qp*pi_q))
   end function wrap_angle

   elemental type(jet_t) function add_jets(a, b) result(c)
      type(jet_t), intent(in) :: a, b

      c = jet_t(a%v + b%v, a%d + b%d, a%dd + b%dd)
   end function add_jets

   elemental type(jet_t) function add_real_right(a, r) result(c)
      type(jet_t), intent(in) :: a
      real(qp), intent(in) :: r

      c = jet_t(a%v + r, a%d, a%dd)
   end function add_real_right

   elemental type(jet_t) function add_real_left(r, a) result(c)
      real(qp), intent(in) :: r
      type(jet_t), intent(in) :: a

      c = jet_t(r + a%v, a%d, a%dd)
   end function add_real_left

   elemental type(jet_t) function negate(a) result(c)
      type(jet_t), intent(in) :: a

      c = jet_t(-a%v, -a%d, -a%dd)
   end function negate

   elemental type(jet_t) function subtract_jets(a, b) result(c)
      type(jet_t), intent(in) :: a, b

      c = jet_t(a%v - b%v, a%d - b%d, a%dd - b%dd)
   end function subtract_jets

   elemental type(jet_t) function subtract_real_right(a, r) result(c)
      type(jet_t), intent(in) :: a
      real(qp), intent(in) :: r

      c = jet_t(a%v - r, a%d, a%dd)
   end function subtract_real_right

   elemental type(jet_t) function subtract_real_left(r, a) result(c)
      real(qp), intent(in) :: r
      type(jet_t), intent(in) :: a

      c = jet_t(r - a%v, -a%d, -a%dd)
   end function subtract_real_left

   !> Leibniz: (ab)'' = a''b + 2a'b' + ab''.
   elemental type(jet_t) function multiply_jets(a, b) result(c)
      type(jet_t), intent(in) :: a, b

      c = jet_t(a%v*b%v, a%d*b%v + a%v*b%d, a%dd*b%v + 2.0_qp*a%d*b%d + a%v*b%dd)
   end function multiply_jets

   elemental type(jet_t) function multiply_real_right(a, r) result(c)
      type(jet_t), intent(in) :: a
      real(qp), intent(in) :: r

      c = jet_t(a%v*r, a%d*r, a%dd*r)
   end function multiply_real_right

   elemental type(jet_t) function multiply_real_left(r, a) result(c)
      real(qp), intent(in) :: r
      type(jet_t), intent(in) :: a

      c = jet_t(r*a%v, r*a%d, r*a%dd)
   end function multiply_real_left

   !> q = a/b from the derivatives of a = q b.
   elemental type(jet_t) function divide_jets(a, b) result(q)
      type(jet_t), intent(in) :: a, b

      q%v = a%v/b%v
      q%d = (a%d - q%v*b%d)/b%v
      q%dd = (a%dd - 2.0_qp*q%d*b%d - q%v*b%dd)/b%v
   end function divide_jets

   elemental type(jet_t) function divide_real_right(a, r) result(q)
      type(jet_t), intent(in) :: a
      real(qp), intent(in) :: r

      q = jet_t(a%v/r, a%d/r, a%dd/r)
   end function divide_real_right

   elemental type(jet_t) function divide_real_left(r, a) result(q)
      real(qp), intent(in) :: r
      type(jet_t), intent(in) :: a

      q = divide_jets(constant_jet(r), a)
   end function divide_real_left

   !> s = sqrt(a) from the derivatives of a = s s; a must be positive.
   elemental type(jet_t) function sqrt_jet(a) result(s)
      type(jet_t), intent(in) :: a

      s%v = sqrt(a%v)
      s%d = a%d/(2.0_qp*s%v)
      s%dd = (a%dd - 2.0_qp*s%d**2)/(2.0_qp*s%v)
   end function sqrt_jet

   elemental type(jet_t) function sin_jet(a) result(s)
      type(jet_t), intent(in) :: a

      s = jet_t(sin(a%v), cos(a%v)*a%d, cos(a%v)*a%dd - sin(a%v)*a%d**2)
   end function sin_jet

   elemental type(jet_t) function cos_jet(a) result(c)
      type(jet_t), intent(in) :: a

      c = jet_t(cos(a%v), -sin(a%v)*a%d, -sin(a%v)*a%dd - cos(a%v)*a%d**2)
   end function cos_jet

   !> w = atan2(y, x) from the derivatives of (x x + y y) w' = x y' - y x'.
   elemental type(jet_t) function atan2_jets(y, x) result(w)
      type(jet_t), intent(in) :: y, x
      real(qp) :: square, square_rate

      square = x%v**2 + y%v**2
      square_rate = 2.0_qp*(x%v*x%d + y%v*y%d)
      w%v = atan2(y%v, x%v)
      w%d = (x%v*y%d - y%v*x%d)/square
      w%dd = (x%v*y%dd - y%v*x%dd - w%d*square_rate)/square
   end function atan2_jets
end module quad_jet
