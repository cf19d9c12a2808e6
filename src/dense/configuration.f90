!> A mechanism made ready for its closure equations, and a position of all its links.
!>
!> Unknowns: x, y, phi of every moving link, in the deck's order. Lengths are divided by a power of two near the
!> characteristic length. This loses no digit, and makes results equal in any unit.
!>
!> A configuration can take the frozen form of the method of 1987, (15): c(phi) = cos(phi)/phi, s(phi) = sin(phi)/phi.
!> Here h, the angle that multiplies c and s, is counted from the nearest zero of the cosine or sine, in each row from
!> its own: cos psi = c(h) h with c(h) = -+ sin(h)/h,  sin psi = s(h) h with s(h) = +- sin(h)/h. For this reason h = 0,
!> at which the print divides by zero and the iteration has a false attractor, is an ordinary position: sin(h)/h is 1
!> there.
module configuration
   use kinds, only: wp
   use plane_vectors, only: rotated, quarter_turn, pi
   use mechanism, only: drive_t, mechanism_t, pair_t, plane_origin
   use scales, only: solver_length, power_of_two
   implicit none
   private
   public :: system_t, configuration_t, new_system, new_configuration, set_configuration, &
      choose_references, normal_angle, add_to_links
   public :: secants

   !> The equations of one mechanism; lengths in units of `length`.
   type :: system_t
      integer :: n = 0                            !< how many equations and unknowns there are
      real(wp) :: length = 1.0_wp                 !< the unit of length, a power of two, in the deck's unit
      real(wp) :: origin(2) = 0.0_wp              !< the point from which x and y are counted, in the deck's unit
      integer, allocatable :: column(:)           !< (links) the unknown that is the link's x; 0: ground
      integer, allocatable :: link_of(:)          !< (points) the number of its link
      real(wp), allocatable :: offset(:, :)       !< (2, points) xi, eta
      type(pair_t), allocatable :: pairs(:)       !< two equations each, in their order; h in the unit of length
      type(drive_t), allocatable :: drives(:)     !< one equation each, after those of the pairs
      real(wp), allocatable :: guide(:, :)        !< (2, pairs) cos alpha, sin alpha
   end type system_t

   !> A position of all links with its directions and body vectors; lengths in the system's unit, angles in radians.
   type :: configuration_t
      real(wp), allocatable :: q(:, :)            !< (3, links) x, y, phi
      real(wp), allocatable :: direction(:, :)    !< (2, links) cos phi, sin phi
      real(wp), allocatable :: body_vector(:, :)  !< (2, points) from the link's origin to the point
      real(wp), allocatable :: slope(:, :)        !< (2, points) derivative of the body vector by phi, or frozen
      logical :: frozen = .false.                 !< slopes and gradients are those of the frozen form
      !> (2, points) frozen: reference angles of the cosine and the sine of the body vector's angle
      real(wp), allocatable :: zeros(:, :)
      !> (2, pairs) frozen: of the guide's normal; for a SLIDE drive exchanged, and a quarter turn added
      real(wp), allocatable :: guide_zeros(:, :)
   end type configuration_t

contains

   !> Makes the closure equations of a mechanism.
   function new_system(m) result(s)
      type(mechanism_t), intent(in) :: m     !< with as many equations as unknowns
      type(system_t) :: s
      integer :: i

      s%length = power_of_two(solver_length(m))
      s%origin = plane_origin(m)
      allocate (s%column(size(m%links)), source=0)
      do i = 1, size(m%links)
         if (m%links(i)%ground) cycle
         s%column(i) = s%n + 1
         s%n = s%n + 3
      end do

      s%link_of = m%points%link
      allocate (s%offset(2, size(m%points)), s%guide(2, size(m%pairs)))
      do i = 1, size(m%points)
         s%offset(:, i) = m%points(i)%offset/s%length
      end do
      s%pairs = m%pairs
      s%pairs%offset = m%pairs%offset/s%length
      s%guide(1, :) = cos(m%pairs%alpha)
      s%guide(2, :) = sin(m%pairs%alpha)
      s%drives = m%drives
   end function new_system

   !> Makes the configuration of the deck: given positions of ground links, estimates of the other links. It is not
   !> frozen.
   pure function new_configuration(system, m) result(p)
      type(system_t), intent(in) :: system   !< of `m`
      type(mechanism_t), intent(in) :: m
      type(configuration_t) :: p
      integer :: i

      allocate (p%q(3, size(m%links)), p%direction(2, size(m%links)))
      allocate (p%body_vector(2, size(m%points)), p%slope(2, size(m%points)), p%zeros(2, size(m%points)))
      allocate (p%guide_zeros(2, size(m%pairs)), source=0.0_wp)
      do i = 1, size(m%links)
         p%q(:, i) = [(m%links(i)%position(:2) - system%origin)/system%length, m%links(i)%position(3)]
      end do
      call set_configuration(system, p)
   end function new_configuration

   !> Finds directions, body vectors and slopes of a configuration from the coordinates of its links, slopes in the
   !> frozen form if the configuration has that. It takes one sine and one cosine a link.
   pure subroutine set_configuration(system, configuration)
      type(system_t), intent(in) :: system   !< the closure equations
      type(configuration_t), intent(inout) :: configuration   !< of the system, with q, frozen and zeros
      integer :: i

      configuration%direction(1, :) = cos(configuration%q(3, :))
      configuration%direction(2, :) = sin(configuration%q(3, :))
      do i = 1, size(system%link_of)
         configuration%body_vector(:, i) = rotated(system%offset(:, i), configuration%direction(:, system%link_of(i)))
         if (configuration%frozen) then
            configuration%slope(:, i) = norm2(system%offset(:, i)) &
               *secants(body_vector_angle(system, configuration, i), configuration%zeros(:, i))
         else
            configuration%slope(:, i) = quarter_turn(configuration%body_vector(:, i))
         end if
      end do
   end subroutine set_configuration

   !> Puts a configuration into the frozen form of (16). Its angles are counted from the zeros nearest to their present
   !> values.
   pure subroutine choose_references(system, configuration)
      type(system_t), intent(in) :: system   !< the closure equations
      type(configuration_t), intent(inout) :: configuration   !< of the system, with directions and body vectors
      integer :: i

      configuration%frozen = .true.
      do i = 1, size(system%link_of)
         configuration%zeros(:, i) = nearest_zeros(body_vector_angle(system, configuration, i))
      end do
      do i = 1, size(system%pairs)
         configuration%guide_zeros(:, i) = nearest_zeros(normal_angle(system, configuration, i))
      end do
      call set_configuration(system, configuration)
   end subroutine choose_references

   !> Adds a change of the unknowns to coordinates of all links, or rates to rates; ground links stay.
   pure subroutine add_to_links(system, change, coordinates)
      type(system_t), intent(in) :: system   !< the closure equations
      real(wp), intent(in) :: change(:)      !< (n) in the system's unit of length and rad, or per unit of time
      real(wp), intent(inout) :: coordinates(:, :)   !< (3, links) x, y, phi or their rates, in these units
      integer :: i

      do i = 1, size(system%column)
         if (system%column(i) > 0) coordinates(:, i) = coordinates(:, i) + change(system%column(i):system%column(i) + 2)
      end do
   end subroutine add_to_links

   !> Gives the angle of the normal of a prismatic pair's guide at a configuration, in rad.
   pure real(wp) function normal_angle(system, configuration, k)
      type(system_t), intent(in) :: system   !< the closure equations
      type(configuration_t), intent(in) :: configuration   !< of the system
      integer, intent(in) :: k   !< the number of the pair

      normal_angle = configuration%q(3, system%link_of(system%pairs(k)%point_i)) + system%pairs(k)%alpha + pi/2.0_wp
   end function normal_angle

   !> Gives the angle of the body vector to a point at a configuration, in rad; of a point at its link's origin the
   !> link's angle.
   pure real(wp) function body_vector_angle(system, configuration, i)
      type(system_t), intent(in) :: system   !< the closure equations
      type(configuration_t), intent(in) :: configuration   !< of the system
      integer, intent(in) :: i   !< the number of the point

      body_vector_angle = configuration%q(3, system%link_of(i)) + atan2(system%offset(2, i), system%offset(1, i))
   end function body_vector_angle

   !> Gives the two angles (2) nearest to an angle at which cos is zero, and at which sin is zero, in rad.
   pure function nearest_zeros(psi) result(zeros)
      real(wp), intent(in) :: psi   !< rad
      real(wp) :: zeros(2)

      zeros(1) = (anint(psi/pi - 0.5_wp) + 0.5_wp)*pi
      zeros(2) = anint(psi/pi)*pi
   end function nearest_zeros

   !> Gives the frozen coefficients (2) of (15): cos(psi)/(psi - zeros(1)) and sin(psi)/(psi - zeros(2)), and at a zero
   !> the limit.
   pure function secants(psi, zeros) result(c)
      real(wp), intent(in) :: psi            !< rad
      real(wp), intent(in) :: zeros(2)       !< rad: the reference angles of cosine and sine
      real(wp) :: c(2)

      c = [-sin(zeros(1)), cos(zeros(2))]
      where (abs(psi - zeros) > tiny(psi)) c = c*(sin(psi - zeros)/(psi - zeros))
   end function secants
end module configuration
