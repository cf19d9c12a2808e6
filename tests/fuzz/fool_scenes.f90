!> Tests. Mechanisms with one block each, whose motion has a closed form in real128: a four-bar, an inverted slider and
!> an offset crank-slider; an arm that turns and slides, driven by the place of its end; a cylinder that drives a lever;
!> and two guides on a crank, at an angle to each other. All but the last have two assemblies, whose sign is that of the
!> determinant. Unknowns are angles and, of the arm and the guides, slides.
module fool_scenes
   use kinds, only: wp
   use quad_jet, only: qp
   use mechanism, only: mechanism_t, link_t, point_t, pair_t, drive_t, term_t, request_t, pair_revolute, &
      pair_prismatic, drive_angle, drive_x, drive_y, drive_slide, term_harmonic, request_link
   use spanning_tree, only: spanning_tree_t, new_tree
   use continuation, only: continuation_t
   implicit none
   private
   public :: fool_t, new_mechanism, find_unknowns, place_at
   public :: scene_four_bar, scene_inverted, scene_slider, scene_arm, scene_cylinder, scene_guides

   integer, parameter :: scene_four_bar = 1   !< crank, coupler, rocker, base
   integer, parameter :: scene_inverted = 2   !< crank, distance of the pivots, offset of the slot
   integer, parameter :: scene_slider = 3     !< crank, rod, height of the guide
   integer, parameter :: scene_arm = 4        !< -, height of the end, offset of the guide; driven: x of the end
   integer, parameter :: scene_cylinder = 5   !< lever, distance of the pivots, offset of the piston; driven: the slide
   integer, parameter :: scene_guides = 6     !< -, distance of the pivots, -, angle of the guides; driven: the crank

   !> A mechanism, and the law of its drive: angle + rate t + swing sin(frequency t + phase).
   type :: fool_t
      integer :: scene = scene_four_bar
      real(wp) :: length(4) = 1.0_wp
      real(wp) :: angle = 0.0_wp, rate = 1.0_wp, swing = 0.0_wp, frequency = 1.0_wp, phase = 0.0_wp
      integer, allocatable :: unknowns(:)     !< of the block, as its engine numbers them
      integer :: slide = 0                    !< which of these is a slide; 0: none
      integer :: pair = 0                     !< whose slide it is
      real(wp) :: unit = 1.0_wp               !< of that
   end type fool_t

contains

   !> As plain data, assembled nowhere in particular.
   function new_mechanism(f) result(m)
      type(fool_t), intent(in) :: f
      type(mechanism_t) :: m
      real(wp), parameter :: origin(2) = 0.0_wp
      integer :: i

      associate (l => f%length)
         select case (f%scene)
         case (scene_four_bar)
            m%links = [link_t('BASE', .true.), link_t('CRANK'), link_t('COUPLER'), link_t('ROCKER')]
            m%points = [point_t('A0', 1, origin), point_t('B0', 1, [l(4), 0.0_wp]), point_t('A0C', 2, origin), &
               point_t('AC', 2, [l(1), 0.0_wp]), point_t('AR', 3, origin), point_t('BR', 3, [l(2), 0.0_wp]), &
               point_t('B0R', 4, origin), point_t('BB', 4, [l(3), 0.0_wp])]
            m%pairs = [revolute(1, 3), revolute(4, 5), revolute(6, 8), revolute(2, 7)]
         case (scene_inverted)
            m%links = [link_t('BASE', .true.), link_t('CRANK'), link_t('LEVER'), link_t('BLOCK')]
            m%points = [point_t('A0', 1, origin), point_t('B0', 1, [l(2), 0.0_wp]), point_t('A0C', 2, origin), &
               point_t('AC', 2, [l(1), 0.0_wp]), point_t('B0L', 3, origin), point_t('P', 4, origin)]
            m%pairs = [revolute(1, 3), revolute(4, 6), revolute(2, 5), &
               pair_t(pair_prismatic, 'GUIDE', 5, 6, 0.0_wp, l(3), 0.0_wp)]
         case (scene_arm)
            m%links = [link_t('BASE', .true.), link_t('ARM'), link_t('BLOCK')]
            m%points = [point_t('B0', 1, origin), point_t('B0L', 2, origin), point_t('P', 3, origin)]
            m%pairs = [revolute(1, 2), pair_t(pair_prismatic, 'GUIDE', 2, 3, 0.0_wp, l(3), 0.0_wp)]
         case (scene_cylinder)
            m%links = [link_t('BASE', .true.), link_t('CYLINDER'), link_t('PISTON'), link_t('LEVER')]
            m%points = [point_t('A0', 1, origin), point_t('B0', 1, [l(2), 0.0_wp]), point_t('A0C', 2, origin), &
               point_t('P', 3, origin), point_t('B0L', 4, origin), point_t('PL', 4, [l(1), 0.0_wp])]
            m%pairs = [revolute(1, 3), revolute(4, 6), revolute(2, 5), &
               pair_t(pair_prismatic, 'GUIDE', 3, 4, 0.0_wp, l(3), 0.0_wp)]
         case (scene_guides)
            m%links = [link_t('BASE', .true.), link_t('CRANK'), link_t('BLOCK'), link_t('TURNED')]
            m%points = [point_t('A0', 1, origin), point_t('B0', 1, [l(2), 0.0_wp]), point_t('A0C', 2, origin), &
               point_t('P', 3, origin), point_t('Q', 4, origin)]
            m%pairs = [revolute(1, 3), revolute(2, 5), pair_t(pair_prismatic, 'G1', 3, 4, 0.0_wp, 0.0_wp, 0.0_wp), &
               pair_t(pair_prismatic, 'G2', 4, 5, l(4), 0.0_wp, 0.0_wp)]
         case default
            m%links = [link_t('BASE', .true.), link_t('CRANK'), link_t('ROD'), link_t('PISTON')]
            m%points = [point_t('A0', 1, origin), point_t('G', 1, [0.0_wp, l(3)]), point_t('A0C', 2, origin), &
               point_t('AC', 2, [l(1), 0.0_wp]), point_t('AR', 3, origin), point_t('BR', 3, [l(2), 0.0_wp]), &
               point_t('B', 4, origin)]
            m%pairs = [revolute(1, 3), revolute(4, 5), revolute(6, 7), &
               pair_t(pair_prismatic, 'GUIDE', 2, 7, 0.0_wp, 0.0_wp, 0.0_wp)]
         end select
      end associate
      m%drives = [drive_t(drive_angle, 2, 0, [f%angle, f%rate, 0.0_wp])]
      if (f%scene == scene_cylinder) m%drives(1)%kind = drive_slide
      if (f%scene == scene_cylinder) m%drives(1)%subject = 4
      if (f%scene == scene_arm) m%drives = [drive_t(drive_x, 3, 0, [f%angle, f%rate, 0.0_wp]), &
         drive_t(drive_y, 3, 0, [f%length(2), 0.0_wp, 0.0_wp])]
      allocate (m%drives(1)%terms(1))
      m%drives(1)%terms(1) = term_t(term_harmonic, [f%swing, f%frequency, f%phase])
      m%requests = [(request_t(request_link, i), i=2, size(m%links))]
      allocate (m%at(1), source=0.0_wp)
      allocate (m%echo(0), m%branch_requests(0))
   end function new_mechanism

   function revolute(i, j) result(pair)
      integer, intent(in) :: i, j
      type(pair_t) :: pair

      pair = pair_t(pair_revolute, 'R', i, j)
   end function revolute

   !> The unknowns of the block of `f`, which is `m` with the engine `e`.
   subroutine find_unknowns(m, e, f)
      type(mechanism_t), intent(in) :: m
      type(continuation_t), intent(in) :: e
      type(fool_t), intent(inout) :: f
      type(spanning_tree_t) :: t

      select case (f%scene)
      case (scene_four_bar)
         f%unknowns = e%blocks%tree%orientation(3:4)
      case (scene_arm)
         f%unknowns = [e%blocks%tree%orientation(2), 0]
         f%slide = 2
         f%pair = 2
      case (scene_cylinder)
         f%unknowns = e%blocks%tree%orientation([2, 4])
      case (scene_guides)
         t = new_tree(m)
         f%unknowns = [0]
         f%slide = 1
         f%pair = merge(3, 4, t%slide(3) > 0)
      case default
         f%unknowns = e%blocks%tree%orientation([3])
      end select
      if (f%slide == 0) return
      f%unknowns(f%slide) = e%blocks%orientations + 1
      f%unit = e%geometry%equations%length*e%geometry%unit(f%unknowns(f%slide))
   end subroutine find_unknowns

   !> The driven number at `t`.
   pure real(qp) function crank_at(f, t) result(angle)
      type(fool_t), intent(in) :: f
      real(qp), intent(in) :: t

      angle = f%angle + f%rate*t + f%swing*sin(f%frequency*t + f%phase)
   end function crank_at

   !> The unknowns at the time `t` in the assembly of the sign `s`, a slide in its unit; `margin` > 0: they exist.
   subroutine place_at(f, t, s, angles, margin)
      type(fool_t), intent(in) :: f
      real(qp), intent(in) :: t
      integer, intent(in) :: s
      real(qp), intent(out) :: angles(2), margin
      real(qp) :: a(2), d(2), square, x, h, b(2), crank

      crank = crank_at(f, t)
      a = f%length(1)*[cos(crank), sin(crank)]
      angles = 0.0_qp
      associate (l => f%length)
         select case (f%scene)
         case (scene_four_bar)
            d = [real(l(4), qp), 0.0_qp] - a
            square = sum(d**2)
            x = (square + real(l(2), qp)**2 - real(l(3), qp)**2)/(2.0_qp*sqrt(square))
            margin = real(l(2), qp)**2 - x**2
            if (margin <= 0.0_qp) return
            h = s*sqrt(margin)
            b = (x*d + h*[-d(2), d(1)])/sqrt(square)
            angles(1) = atan2(b(2), b(1))
            b = a + b - [real(l(4), qp), 0.0_qp]
            angles(2) = atan2(b(2), b(1))
         case (scene_inverted, scene_arm)
            ! From the pivot the pin, or the end, has the distance of the guide from it: d . n = -h.
            d = [crank, real(l(2), qp)]
            if (f%scene == scene_inverted) d = a - [real(l(2), qp), 0.0_qp]
            square = sum(d**2)
            margin = square - real(l(3), qp)**2
            if (margin <= 0.0_qp) return
            angles(1) = atan2(d(2), d(1)) + asin(l(3)/sqrt(square))
            if (s < 0) angles(1) = atan2(d(2), d(1)) + acos(-1.0_qp) - asin(l(3)/sqrt(square))
            if (f%scene == scene_arm) angles(2) = s*sqrt(margin)/f%unit
         case (scene_cylinder)
            square = crank**2 + real(l(3), qp)**2
            x = (square + real(l(2), qp)**2 - real(l(1), qp)**2)/(2.0_qp*l(2))
            margin = square - x**2
            if (margin <= 0.0_qp) return
            angles(1) = atan2(s*sqrt(margin), x) - atan2(-real(l(3), qp), crank)
            angles(2) = atan2(s*sqrt(margin), x - l(2))
         case (scene_guides)
            margin = 1.0_qp
            angles(1) = merge(l(2)*sin(crank + l(4)), -l(2)*sin(crank), f%pair == 3)/sin(real(l(4), qp))/f%unit
         case default
            x = l(3) - a(2)
            margin = real(l(2), qp)**2 - x**2
            if (margin <= 0.0_qp) return
            angles(1) = atan2(x, s*sqrt(margin))
         end select
      end associate
   end subroutine place_at
end module fool_scenes
