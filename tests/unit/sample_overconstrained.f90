!> Tests. Mechanisms with too many equations, and one that a drive does not hold, built from the samples.
module sample_overconstrained
   use kinds, only: wp
   use mechanism, only: mechanism_t, link_t, point_t, pair_t, request_t, request_link, pair_revolute
   use sample_mechanisms, only: four_bar
   implicit none
   private
   public :: parallelogram, antiparallelogram, crossed_rocker, three_cranks

contains

   !> Cranks 2 at `phi`, coupler and base 4; the drive turns the crank at 1 rad a unit of time.
   function parallelogram(phi) result(m)
      real(wp), intent(in) :: phi
      type(mechanism_t) :: m

      m = four_bar()
      m%points(4)%offset = [2.0_wp, 0.0_wp]
      m%points(6)%offset = [4.0_wp, 0.0_wp]
      m%points(8)%offset = [2.0_wp, 0.0_wp]
      m%links(2)%position(3) = phi
      m%links(3)%position(3) = 0.0_wp
      m%links(4)%position(3) = phi
      m%drives(1)%polynomial = [phi, 1.0_wp, 0.0_wp]
      m%pairs%name = ['A0      ', 'A       ', 'B       ', 'B0      ']
   end function parallelogram

   !> The same crossed, with cranks of length `crank`.
   function antiparallelogram(crank, phi) result(m)
      real(wp), intent(in) :: crank, phi
      type(mechanism_t) :: m

      m = parallelogram(phi)
      m%points([4, 8])%offset(1) = crank
      m%links(4)%position(3) = crossed_rocker(crank, phi)
      m%links(3)%position(3) = m%links(4)%position(3) + phi
   end function antiparallelogram

   !> The angle r of its rocker, with the crank at `p`: tan(r/2) = -(4 + crank)/(4 - crank) tan(p/2). The coupler is at p + r.
   pure real(wp) function crossed_rocker(crank, p)
      real(wp), intent(in) :: crank, p

      crossed_rocker = 2.0_wp*atan2(-(4.0_wp + crank)*sin(0.5_wp*p), (4.0_wp - crank)*cos(0.5_wp*p))
   end function crossed_rocker

   !> The parallelogram with a third crank, from (1, 1) to the coupler's point (1, 1), longer than the others by `excess`.
   function three_cranks(phi, excess) result(m)
      real(wp), intent(in) :: phi, excess
      type(mechanism_t) :: m
      integer :: i

      m = parallelogram(phi)
      m%links = [m%links, link_t('THIRD', position=[1.0_wp, 1.0_wp, phi])]
      m%points = [m%points, point_t('C0', 1, [1.0_wp, 1.0_wp]), point_t('C', 3, [1.0_wp, 1.0_wp]), &
                  point_t('C1', 5, [0.0_wp, 0.0_wp]), point_t('C2', 5, [2.0_wp + excess, 0.0_wp])]
      m%pairs = [m%pairs, pair_t(pair_revolute, 'C0', 9, 11), pair_t(pair_revolute, 'C', 10, 12)]
      m%requests = [(request_t(request_link, i, 1), i=1, size(m%links))]
   end function three_cranks
end module sample_overconstrained
