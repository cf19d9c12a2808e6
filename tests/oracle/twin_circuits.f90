!> Tests. Symmetric mechanisms, in which two blocks are singular at one value of the drive, and their branches and circuits
!> by closed forms.
!>
!> Grippers (a slide), twin rockers and gates (a crank) move the ends of two dyads, each of which is assembled in two ways
!> where the distance of its ends lies between the difference and the sum of its bars. At a limit of one dyad its two
!> assemblies meet; at a common limit both change. Bars, tongs and lifts of crossed bars of the length b are all in line at
!> the values -b and b of the drive; each stage and the platform is assembled in two ways, and there all change.
module twin_circuits
   use kinds, only: wp
   use plane_vectors, only: pi
   use mechanism, only: mechanism_t, link_t, point_t, pair_t, drive_t, request_t, request_link, pair_revolute, &
      pair_prismatic, drive_angle, drive_slide, drive_y
   use dice, only: dice_t, between, chance, throw
   implicit none
   private
   public :: twin_t, throw_twin, max_stages

   integer, parameter :: max_stages = 3
   !> Values of the drive at which dyads are looked at, and where a slide is.
   integer, parameter :: samples = 4000
   real(wp), parameter :: widest = 12.0_wp
   !> Limits that are nearer to one another are not told apart by the samples; such dyads are not taken.
   real(wp), parameter :: clear = 0.02_wp
   !> Limits of two dyads that are one differ by rounding.
   real(wp), parameter :: one_limit = 1.0e-10_wp

   !> A mechanism, its branches and circuits, and how many assemblies it has at its first instant.
   type :: twin_t
      type(mechanism_t) :: m
      character(16) :: name = ''
      real(wp), allocatable :: ranges(:, :)    !< (2, branches) of the drive (rad or length)
      logical, allocatable :: turns(:)         !< (branches) the drive turns fully
      integer :: circuits = 0
      integer :: assemblies = 0
   end type twin_t

   !> Two dyads between the points `at` and `pivot` at the value 0 of the drive.
   type :: dyads_t
      logical :: is_slide = .false.            !< the drive moves `at` along x, otherwise it turns it about 0
      real(wp) :: at(2, 2) = 0.0_wp, pivot(2, 2) = 0.0_wp      !< (2, dyads)
      real(wp) :: bar(2, 2) = 0.0_wp                           !< (2, dyads) lengths
   end type dyads_t

contains

   !> A mechanism by chance.
   subroutine throw_twin(d, twin)
      type(dice_t), intent(inout) :: d
      type(twin_t), intent(out) :: twin

      if (chance(d, 0.7_wp)) then
         call throw_dyads(d, twin)
      else
         call throw_bars(d, twin)
      end if
   end subroutine throw_twin

   !> A gripper, twin rockers or a gate; in one of four the second dyad is a little larger.
   subroutine throw_dyads(d, twin)
      type(dice_t), intent(inout) :: d
      type(twin_t), intent(out) :: twin
      character(*), parameter :: names(3) = ['GRIPPER', 'ROCKERS', 'GATE   ']
      type(dyads_t) :: p
      real(wp) :: v
      integer :: kind
      logical :: is_clear

      do
         kind = throw(d, 3)
         p%is_slide = kind == 1
         p%at(:, 1) = [0.0_wp, between(d, 0.2_wp, 1.5_wp)]
         p%pivot(:, 1) = [between(d, -1.0_wp, 3.0_wp), between(d, -1.5_wp, 1.5_wp)]
         p%bar(:, 1) = [between(d, 0.5_wp, 2.5_wp), between(d, 0.5_wp, 2.5_wp)]
         select case (kind)
         case (1)
            p%at(:, 2) = p%at(:, 1)*[1, -1]
            p%pivot(:, 2) = p%pivot(:, 1)*[1, -1]
         case (2)
            p%at(:, 2) = p%at(:, 1)
            p%pivot(:, 2) = p%pivot(:, 1)
         case (3)
            p%at(:, 2) = -p%at(:, 1)
            p%pivot(:, 2) = -p%pivot(:, 1)
         end select
         p%bar(:, 2) = p%bar(:, 1)
         if (chance(d, 0.25_wp)) p%bar(:, 2) = p%bar(:, 1)*(1.0_wp + 10.0_wp**(-throw(d, 4)))
         if (norm2(p%pivot(:, 1)) < 0.2_wp .or. abs(p%bar(1, 1) - p%bar(2, 1)) < 0.05_wp) cycle
         twin%name = names(kind)
         call find_branches(p, twin, is_clear)
         if (is_clear .and. size(twin%ranges) > 0) exit
      end do
      v = between(d, twin%ranges(1, 1) + clear, twin%ranges(2, 1) - clear)
      twin%assemblies = 4
      call build_dyads(p, v, twin%m)
   end subroutine throw_dyads

   !> The branches and circuits of `p`. `is_clear`: no limits are so near to one another that a sample may miss them.
   subroutine find_branches(p, twin, is_clear)
      type(dyads_t), intent(in) :: p
      type(twin_t), intent(inout) :: twin
      logical, intent(out) :: is_clear
      real(wp), allocatable :: ends(:)
      real(wp) :: room(0:samples + 1, 2), least(0:samples + 1), v
      integer :: k, i, flips(2, 2)

      do k = 0, samples + 1
         room(k, :) = [(margin(p, sample(p, k), i), i=1, 2)]
      end do
      least = minval(room, dim=2)
      twin%ranges = reshape([real(wp) ::], [2, 0])
      twin%circuits = 0
      is_clear = .not. (any((room(1:samples, :) > room(:samples - 1, :)) .and. room(1:samples, :) > room(2:, :) &
         .and. abs(room(1:samples, :)) < clear) .or. any(room(1:samples, :) < room(:samples - 1, :) &
         .and. room(1:samples, :) < room(2:, :) .and. abs(room(1:samples, :)) < clear))
      if (all(least > 0.0_wp)) then
         twin%ranges = reshape([(0.0_wp, 2.0_wp*pi, i=1, 4)], [2, 4])
         twin%turns = spread(.true., 1, 4)
         twin%circuits = 4
         is_clear = is_clear .and. .not. p%is_slide
         return
      end if
      do k = 0, samples - 1
         if (least(k) >= 0.0_wp .or. least(k + 1) < 0.0_wp) cycle
         i = k + 1
         do while (minval([margin(p, sample(p, i), 1), margin(p, sample(p, i), 2)]) >= 0.0_wp)
            i = i + 1
         end do
         call find_limit(p, sample(p, k), sample(p, k + 1), v, flips(:, 1))
         ends = [v]
         call find_limit(p, sample(p, i), sample(p, i - 1), v, flips(:, 2))
         ends = [ends, v]
         is_clear = is_clear .and. ends(2) - ends(1) > 6.0_wp*clear
         twin%ranges = reshape([twin%ranges, (ends, i=1, 4)], [2, size(twin%ranges, 2) + 4])
         ! Where the same dyads change at both ends there are two circuits, otherwise one.
         twin%circuits = twin%circuits + merge(2, 1, all(flips(:, 1) == flips(:, 2)))
      end do
      twin%turns = spread(.false., 1, size(twin%ranges, 2))
   end subroutine find_branches

   !> Value number `k` of the drive.
   pure real(wp) function sample(p, k) result(v)
      type(dyads_t), intent(in) :: p
      integer, intent(in) :: k

      v = 2.0_wp*pi*(real(k, wp) + 0.1_wp)/real(samples, wp)
      if (p%is_slide) v = widest*(2.0_wp*real(k, wp)/real(samples, wp) - 1.0_wp)
   end function sample

   !> How far dyad number `i` is from its limits at the drive's value `v`; below 0: it is not assembled.
   pure real(wp) function margin(p, v, i) result(room)
      type(dyads_t), intent(in) :: p
      real(wp), intent(in) :: v
      integer, intent(in) :: i
      real(wp) :: apart

      apart = norm2(end_at(p, v, i) - p%pivot(:, i))
      room = min(sum(p%bar(:, i)) - apart, apart - abs(p%bar(1, i) - p%bar(2, i)))
   end function margin

   !> The end of dyad number `i` that the drive moves.
   pure function end_at(p, v, i) result(x)
      type(dyads_t), intent(in) :: p
      real(wp), intent(in) :: v
      integer, intent(in) :: i
      real(wp) :: x(2)

      x = p%at(:, i) + [v, 0.0_wp]
      if (.not. p%is_slide) x = [p%at(1, i)*cos(v) - p%at(2, i)*sin(v), p%at(1, i)*sin(v) + p%at(2, i)*cos(v)]
   end function end_at

   !> The limit `v` between `outside` and `inside`, and which dyads change there (1, otherwise 0).
   subroutine find_limit(p, outside, inside, v, flips)
      type(dyads_t), intent(in) :: p
      real(wp), intent(in) :: outside, inside
      real(wp), intent(out) :: v
      integer, intent(out) :: flips(2)
      real(wp) :: a, b, limits(2)
      integer :: i, k

      do i = 1, 2
         a = outside
         b = inside
         limits(i) = outside
         if (margin(p, a, i) >= 0.0_wp) cycle
         do k = 1, digits(1.0_wp) + 4
            limits(i) = 0.5_wp*(a + b)
            if (margin(p, limits(i), i) >= 0.0_wp) b = limits(i)
            if (margin(p, limits(i), i) < 0.0_wp) a = limits(i)
         end do
      end do
      k = minloc(abs(limits - inside), dim=1)
      v = limits(k)
      flips = merge(1, 0, abs(limits - v) <= one_limit)
   end subroutine find_limit

   !> The mechanism of the dyads `p` at the drive's value `v`, both on one side of the way between their ends.
   subroutine build_dyads(p, v, m)
      type(dyads_t), intent(in) :: p
      real(wp), intent(in) :: v
      type(mechanism_t), intent(out) :: m
      real(wp) :: x(2), e(2), along, apart, knee(2)
      integer :: i

      call begin(m)
      call add_link(m, [0.0_wp, 0.0_wp])
      if (p%is_slide) then
         call add_slide(m, 1, 2, [0.0_wp, 0.0_wp], [v, 0.0_wp])
         m%drives = [drive_t(kind=drive_slide, subject=1)]
         m%drives(1)%polynomial(1) = v
      else
         call add_joint(m, 1, 2, [0.0_wp, 0.0_wp])
         m%drives = [drive_t(kind=drive_angle, subject=2)]
         ! Link 2 is drawn at its angle 0: the others are counted from where they are then.
         m%drives(1)%polynomial(1) = 0.0_wp
      end if
      do i = 1, 2
         x = end_at(p, v, i)
         apart = norm2(p%pivot(:, i) - x)
         e = (p%pivot(:, i) - x)/apart
         along = (apart**2 + p%bar(1, i)**2 - p%bar(2, i)**2)/(2.0_wp*apart)
         knee = x + along*e + sqrt(p%bar(1, i)**2 - along**2)*[-e(2), e(1)]
         call add_link(m, x)
         call add_link(m, p%pivot(:, i))
         call add_joint(m, 2, size(m%links) - 1, x)
         call add_joint(m, size(m%links) - 1, size(m%links), knee)
         call add_joint(m, size(m%links), 1, p%pivot(:, i))
      end do
      if (.not. p%is_slide) then
         m%drives(1)%polynomial(1) = v
         m%links(2)%position(3) = v
         do i = 1, size(m%points)
            if (m%points(i)%link == 2) m%points(i)%offset = turned_back(m%points(i)%offset)
         end do
      end if
      m%requests = [(request_t(request_link, i), i=1, size(m%links))]

   contains

      pure function turned_back(x) result(y)
         real(wp), intent(in) :: x(2)
         real(wp) :: y(2)

         y = [x(1)*cos(v) + x(2)*sin(v), -x(1)*sin(v) + x(2)*cos(v)]
      end function turned_back
   end subroutine build_dyads

   !> Tongs or a lift of crossed bars, driven by the slide; of one stage also by the height.
   subroutine throw_bars(d, twin)
      type(dice_t), intent(inout) :: d
      type(twin_t), intent(out) :: twin
      real(wp) :: bar, c, s, limit
      integer :: stages, i, a, b, shoe, ways
      logical :: is_lift, by_height

      stages = throw(d, max_stages)
      is_lift = chance(d, 0.5_wp)
      by_height = stages == 1 .and. chance(d, 0.5_wp)
      if (is_lift .and. stages == max_stages) stages = 1
      bar = between(d, 0.5_wp, 3.0_wp)
      c = between(d, 0.2_wp, 0.6_wp)
      s = bar*sin(c)
      c = bar*cos(c)
      associate (m => twin%m)
         call begin(m)
         call add_link(m, [c, 0.0_wp])
         shoe = 2
         call add_slide(m, 1, shoe, [0.0_wp, 0.0_wp], [c, 0.0_wp])
         do i = 1, stages
            a = 2*i + 1
            b = a + 1
            call add_link(m, [merge(0.0_wp, c, modulo(i, 2) == 1), s*(i - 1)])
            call add_link(m, [merge(c, 0.0_wp, modulo(i, 2) == 1), s*(i - 1)])
            if (i == 1) then
               call add_joint(m, 1, a, [0.0_wp, 0.0_wp])
               call add_joint(m, b, shoe, [c, 0.0_wp])
            else
               ! Each bar goes on where a bar of the stage below ends.
               call add_joint(m, a - 2, a, [merge(0.0_wp, c, modulo(i, 2) == 1), s*(i - 1)])
               call add_joint(m, b - 2, b, [merge(c, 0.0_wp, modulo(i, 2) == 1), s*(i - 1)])
            end if
            call add_joint(m, a, b, [0.5_wp*c, s*(i - 0.5_wp)])
         end do
         ways = 2**stages
         if (is_lift) then
            ! The platform is joined to the bar that ends at x = 0; the other one slides in it.
            call add_link(m, [0.0_wp, s*stages])
            call add_link(m, [c, s*stages])
            i = size(m%links)
            call add_joint(m, merge(b, a, modulo(stages, 2) == 1), i - 1, [0.0_wp, s*stages])
            call add_joint(m, merge(a, b, modulo(stages, 2) == 1), i, [c, s*stages])
            call add_slide(m, i - 1, i, [0.0_wp, s*stages], [c, s*stages])
            ways = 2*ways
         end if
         limit = bar
         m%drives = [drive_t(kind=drive_slide, subject=1)]
         m%drives(1)%polynomial(1) = c
         if (by_height) then
            m%points = [m%points, point_t('TOP', 4, [-c, s])]
            m%drives = [drive_t(kind=drive_y, subject=size(m%points))]
            m%drives(1)%polynomial(1) = s
            ! The slide's place is left open: one way more.
            if (.not. is_lift) ways = 4
         end if
         m%requests = [(request_t(request_link, i), i=1, size(m%links))]
      end associate
      twin%name = merge('LIFT  ', 'TONGS ', is_lift)//merge(' BY HEIGHT', '          ', by_height)
      twin%ranges = reshape([(-limit, limit, i=1, ways)], [2, ways])
      twin%turns = spread(.false., 1, ways)
      twin%circuits = ways/2
      twin%assemblies = ways
   end subroutine throw_bars

   !> A mechanism of the ground alone.
   subroutine begin(m)
      type(mechanism_t), intent(out) :: m

      m%links = [link_t('G', .true.)]
      allocate (m%points(0), m%pairs(0))
      m%at = [0.0_wp]
   end subroutine begin

   !> A link at its angle 0 with the origin `at`.
   subroutine add_link(m, at)
      type(mechanism_t), intent(inout) :: m
      real(wp), intent(in) :: at(2)

      m%links = [m%links, link_t('L'//achar(iachar('A') + size(m%links)), position=[at, 0.0_wp])]
   end subroutine add_link

   !> A revolute pair of links `i` and `j` at the place `at`.
   subroutine add_joint(m, i, j, at)
      type(mechanism_t), intent(inout) :: m
      integer, intent(in) :: i, j
      real(wp), intent(in) :: at(2)

      call add_point(m, i, at)
      call add_point(m, j, at)
      m%pairs = [m%pairs, pair_t(pair_revolute, 'R'//achar(iachar('A') + size(m%pairs)), size(m%points) - 1, &
         size(m%points))]
   end subroutine add_joint

   !> A prismatic pair along x: the guide in link `i` goes through `from`, the shoe of link `j` is at `at`.
   subroutine add_slide(m, i, j, from, at)
      type(mechanism_t), intent(inout) :: m
      integer, intent(in) :: i, j
      real(wp), intent(in) :: from(2), at(2)

      call add_point(m, i, from)
      call add_point(m, j, at)
      m%pairs = [m%pairs, pair_t(pair_prismatic, 'S'//achar(iachar('A') + size(m%pairs)), size(m%points) - 1, &
         size(m%points))]
   end subroutine add_slide

   !> A point of link `i` at the place `at`.
   subroutine add_point(m, i, at)
      type(mechanism_t), intent(inout) :: m
      integer, intent(in) :: i
      real(wp), intent(in) :: at(2)
      character(8) :: name

      write (name, '(a, i0)') 'P', size(m%points) + 1
      m%points = [m%points, point_t(name, i, at - m%links(i)%position(:2))]
   end subroutine add_point
end module twin_circuits
