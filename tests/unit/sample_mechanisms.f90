!> Tests. Mechanisms built by hand, as plain data, with rough positions near t = 0 of the closed forms.
module sample_mechanisms
   use kinds, only: wp
   use plane_vectors, only: degree
   use mechanism, only: mechanism_t, link_t, point_t, pair_t, drive_t, request_t, pair_revolute, pair_prismatic, &
      drive_angle, drive_x, drive_y, drive_relangle, drive_slide, request_link
   implicit none
   private
   public :: four_bar, yoke, crank_slider, in_line_slider, piston_outwards, all_kinds, magnified, twice, angle_drive

contains

   !> Crank 1, coupler 3.5, rocker 3 on the base 4, open; the crank turns at 30 deg a unit of time.
   function four_bar() result(m)
      type(mechanism_t) :: m

      m%links = [base(), moving('CRANK', 0.0_wp, 0.0_wp, 0.0_wp), moving('COUPLER', 1.0_wp, 0.0_wp, 1.0_wp), &
                 moving('ROCKER', 4.0_wp, 0.0_wp, 1.6_wp)]
      m%points = [point_t('A0', 1, [0.0_wp, 0.0_wp]), point_t('B0', 1, [4.0_wp, 0.0_wp]), &
                  point_t('CRANK-0', 2, [0.0_wp, 0.0_wp]), point_t('CRANK-A', 2, [1.0_wp, 0.0_wp]), &
                  point_t('ROD-A', 3, [0.0_wp, 0.0_wp]), point_t('ROD-B', 3, [3.5_wp, 0.0_wp]), &
                  point_t('ARM-0', 4, [0.0_wp, 0.0_wp]), point_t('ARM-B', 4, [3.0_wp, 0.0_wp])]
      m%pairs = [revolute(1, 3), revolute(4, 5), revolute(6, 8), revolute(2, 7)]
      m%drives = [angle_drive(2, 0.0_wp, 30.0_wp*degree, 0.0_wp)]
      call finish(m)
   end function four_bar

   !> The paper's yoke mechanism, r = 1, l1 = 4, l2 = 2, a = 2, b = 5, the ram to the right of the lever's tip.
   function yoke() result(m)
      type(mechanism_t) :: m

      m%links = [base(), moving('CRANK', 0.0_wp, 2.0_wp, 0.0_wp), moving('BLOCK', 1.0_wp, 2.0_wp, 1.1_wp), &
                 moving('LEVER', 0.0_wp, 0.0_wp, 1.1_wp), moving('ROD', 1.8_wp, 3.6_wp, 0.8_wp), &
                 moving('RAM', 3.2_wp, 5.0_wp, 0.0_wp)]
      m%points = [point_t('O', 1, [0.0_wp, 0.0_wp]), point_t('C', 1, [0.0_wp, 2.0_wp]), &
                  point_t('GUIDE', 1, [0.0_wp, 5.0_wp]), &
                  point_t('CRANK-C', 2, [0.0_wp, 0.0_wp]), point_t('PIN', 2, [1.0_wp, 0.0_wp]), &
                  point_t('BLOCK-P', 3, [0.0_wp, 0.0_wp]), &
                  point_t('LEVER-O', 4, [0.0_wp, 0.0_wp]), point_t('TIP', 4, [4.0_wp, 0.0_wp]), &
                  point_t('ROD-T', 5, [0.0_wp, 0.0_wp]), point_t('ROD-R', 5, [2.0_wp, 0.0_wp]), &
                  point_t('RAM-R', 6, [0.0_wp, 0.0_wp])]
      m%pairs = [revolute(2, 4), revolute(5, 6), revolute(1, 7), revolute(8, 9), revolute(10, 11), &
                 prismatic(7, 6, 0.0_wp, 0.0_wp, 0.0_wp), prismatic(3, 11, 0.0_wp, 0.0_wp, 0.0_wp)]
      m%drives = [angle_drive(2, 0.0_wp, 30.0_wp*degree, 0.0_wp)]
      call finish(m)
   end function yoke

   !> Crank 1, rod 3, slide line at the height `height`; the crank turns at 60 deg a unit of time.
   function crank_slider(height) result(m)
      real(wp), intent(in) :: height
      type(mechanism_t) :: m

      m%links = [base(), moving('CRANK', 0.0_wp, 0.0_wp, 0.0_wp), moving('ROD', 1.0_wp, 0.0_wp, 0.1_wp), &
                 moving('PISTON', 4.0_wp, height, 0.0_wp)]
      m%points = [point_t('O', 1, [0.0_wp, 0.0_wp]), point_t('GUIDE', 1, [0.0_wp, height]), &
                  point_t('CRANK-O', 2, [0.0_wp, 0.0_wp]), point_t('PIN', 2, [1.0_wp, 0.0_wp]), &
                  point_t('ROD-P', 3, [0.0_wp, 0.0_wp]), point_t('ROD-S', 3, [3.0_wp, 0.0_wp]), &
                  point_t('S', 4, [0.0_wp, 0.0_wp])]
      m%pairs = [revolute(1, 3), revolute(4, 5), revolute(6, 7), prismatic(2, 7, 0.0_wp, 0.0_wp, 0.0_wp)]
      m%drives = [angle_drive(2, 0.0_wp, 60.0_wp*degree, 0.0_wp)]
      call finish(m)
   end function crank_slider

   !> The central crank-slider in line at x = 4, moved by its piston: X = `x` - t/4.
   function in_line_slider(x) result(m)
      real(wp), intent(in) :: x
      type(mechanism_t) :: m

      m = crank_slider(0.0_wp)
      m%links(3)%position(3) = 0.0_wp
      m%drives(1)%kind = drive_x
      m%drives(1)%subject = 7
      m%drives(1)%polynomial = [x, -0.25_wp, 0.0_wp]
   end function in_line_slider

   !> The same slider, crank up: its piston is at x = 3.5 + t/4 and comes to its dead point at t = 2.
   function piston_outwards() result(m)
      type(mechanism_t) :: m

      m = in_line_slider(3.5_wp)
      m%drives(1)%polynomial(2) = 0.25_wp
      m%links(2)%position(3) = 0.9_wp
      m%links(3)%position = [0.6_wp, 0.8_wp, -0.3_wp]
      m%links(4)%position(1) = 3.5_wp
   end function piston_outwards

   !> No machine, but every kind of pair and drive, ground on either side of a pair, no angle or arm a special one.
   function all_kinds() result(m)
      type(mechanism_t) :: m

      m%links = [base(), moving('A', 0.7_wp, -0.4_wp, 0.6_wp), moving('B', 1.9_wp, 0.8_wp, -2.3_wp), &
                 moving('C', -0.6_wp, 1.7_wp, 4.1_wp), moving('D', 2.2_wp, -1.3_wp, 1.9_wp), &
                 moving('E', -1.5_wp, -0.9_wp, -0.35_wp)]
      m%links(1)%position = [0.3_wp, -0.2_wp, 0.4_wp]
      m%points = [point_t('G1', 1, [0.9_wp, 0.2_wp]), point_t('G2', 1, [-0.4_wp, 0.7_wp]), &
                  point_t('A1', 2, [-0.3_wp, 0.5_wp]), point_t('A2', 2, [2.1_wp, 0.4_wp]), &
                  point_t('B1', 3, [0.6_wp, -0.8_wp]), point_t('B2', 3, [-0.7_wp, -0.2_wp]), &
                  point_t('C1', 4, [0.25_wp, 1.3_wp]), point_t('C2', 4, [-1.2_wp, 0.1_wp]), &
                  point_t('D1', 5, [0.8_wp, 0.9_wp]), point_t('E1', 6, [-0.5_wp, 0.3_wp])]
      m%pairs = [revolute(1, 3), revolute(4, 5), prismatic(6, 7, 0.7_wp, 0.3_wp, -0.4_wp), &
                 prismatic(2, 9, -1.1_wp, 0.2_wp, 0.5_wp), prismatic(10, 1, 2.6_wp, -0.6_wp, 0.1_wp)]
      m%drives = [angle_drive(2, 0.3_wp, 0.2_wp, 0.1_wp), drive_t(drive_x, 6, 0, [0.4_wp, 0.3_wp, 0.2_wp]), &
                  drive_t(drive_y, 8, 0, [0.1_wp, -0.3_wp, 0.7_wp]), &
                  drive_t(drive_relangle, 2, 5, [0.2_wp, 0.1_wp, 0.6_wp]), &
                  drive_t(drive_slide, 3, 0, [0.9_wp, 0.8_wp, -0.5_wp])]
      call finish(m)
   end function all_kinds

   !> `m` with every length multiplied by `factor`.
   function magnified(m, factor) result(large)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: factor
      type(mechanism_t) :: large
      integer :: i

      large = m
      do i = 1, size(m%links)
         large%links(i)%position(:2) = factor*m%links(i)%position(:2)
      end do
      do i = 1, size(m%points)
         large%points(i)%offset = factor*m%points(i)%offset
      end do
      large%pairs%offset = factor*m%pairs%offset
      do i = 1, size(m%drives)
         if (any(m%drives(i)%kind == [drive_x, drive_y, drive_slide])) &
            large%drives(i)%polynomial = factor*m%drives(i)%polynomial
      end do
   end function magnified

   !> `m` with a copy of all its moving links.
   function twice(m) result(both)
      type(mechanism_t), intent(in) :: m
      type(mechanism_t) :: both
      integer :: n

      n = size(m%links)
      both = m
      both%links = [m%links, m%links(2:)]
      both%points = [m%points, m%points]
      where (both%points(size(m%points) + 1:)%link > 1) &
         both%points(size(m%points) + 1:)%link = both%points(size(m%points) + 1:)%link + n - 1
      both%pairs = [m%pairs, m%pairs]
      both%pairs(size(m%pairs) + 1:)%point_i = m%pairs%point_i + size(m%points)
      both%pairs(size(m%pairs) + 1:)%point_j = m%pairs%point_j + size(m%points)
      both%drives = [m%drives, m%drives]
      both%drives(size(m%drives) + 1:)%subject = m%drives%subject + n - 1
   end function twice

   !> The angle of `link` is value + rate t + acceleration t^2/2.
   type(drive_t) function angle_drive(link, value, rate, acceleration) result(drive)
      integer, intent(in) :: link
      real(wp), intent(in) :: value, rate, acceleration

      drive = drive_t(drive_angle, link, 0, [value, rate, acceleration])
   end function angle_drive

   type(link_t) function base()
      base = link_t('BASE', .true.)
   end function base

   type(link_t) function moving(name, x, y, phi)
      character(*), intent(in) :: name
      real(wp), intent(in) :: x, y, phi

      moving = link_t(name, position=[x, y, phi])
   end function moving

   type(pair_t) function revolute(i, j)
      integer, intent(in) :: i, j

      revolute = pair_t(pair_revolute, '', i, j)
   end function revolute

   type(pair_t) function prismatic(i, j, alpha, offset, beta)
      integer, intent(in) :: i, j
      real(wp), intent(in) :: alpha, offset, beta

      prismatic = pair_t(pair_prismatic, '', i, j, alpha, offset, beta)
   end function prismatic

   !> What the deck reader would add: the tables of all links, and no instants.
   subroutine finish(m)
      type(mechanism_t), intent(inout) :: m
      integer :: i

      allocate (m%at(0))
      m%requests = [(request_t(request_link, i, 1), i=1, size(m%links))]
   end subroutine finish
end module sample_mechanisms
