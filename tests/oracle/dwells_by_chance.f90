!> Dwells on singular positions: random four-bars, crank-sliders, parallelograms and kites, which RISE drives onto a
!> dead point or a change point, dwells there, and drives on or back, against the closure of their loops; some with a
!> BRANCH card.
!> dwells_by_chance COUNT [FIRST SEED]; the last line is `N passed, N failed`.
program dwells_by_chance
   use kinds, only: wp
   use plane_vectors, only: pi, wrap_angle
   use mechanism, only: drive_t, mechanism_t, branch_request_t, term_t, term_cycloid, drive_x, instant
   use drives, only: drive_motion
   use motion, only: motion_t, new_motion
   use analysis, only: analysis_t, make_analysis, advance
   use sample_mechanisms, only: four_bar, crank_slider
   use dice, only: dice_t, new_dice, between, chance, throw
   use test_counter, only: count_seeds
   implicit none

   !> Roundings of angles and lengths up to 10, over the sine of the angle between the two links of the dyad; on the
   !> singular position itself the closed form knows the root of them.
   real(wp), parameter :: rounding = 2.0e-13_wp, root = 2.0e-7_wp
   !> An instant that is flagged so shortly after the dwell may be on either branch: so much are they apart there.
   real(wp), parameter :: either = 4.0e-6_wp
   !> An instant stands on a change point where the drive's value is so near to that; on a dead point at its square.
   real(wp), parameter :: at_place = 1.0e-7_wp, hardly_off(2) = [1.0e-8_wp, 1.0e-6_wp]
   integer, parameter :: kinds_of = 6, kind_slider = 5, kind_piston = 6

   !> A mechanism and its closed form.
   type :: scene_t
      integer :: kind = 0                  !< of mechanism
      real(wp) :: a = 1.0_wp, b = 1.0_wp, c = 1.0_wp, d = 1.0_wp   !< crank, coupler or rod, rocker, base or height
      real(wp) :: singular = 0.0_wp        !< the drive's value there
      real(wp) :: start = 0.0_wp           !< the drive's value at first
      logical :: goes_on = .false.         !< through it
      logical :: has_card = .false.        !< a BRANCH card asks for the other branch after the dwell
      integer :: side = 1                  !< on which side of its line the dyad is, at first
      type(mechanism_t) :: m
   end type scene_t

   call count_seeds(agrees, 500)

contains

   !> Whether the positions of the mechanism of `seed` are those of its closed form at all instants, in steps of four
   !> sizes.
   logical function agrees(seed)
      integer, intent(in) :: seed
      type(dice_t) :: d
      type(scene_t) :: s
      integer :: steps

      d = new_dice(seed)
      call throw_scene(d, s)
      call throw_rises(d, s)
      agrees = .true.
      steps = 7
      do while (steps <= 56 .and. agrees)
         s%m%steps = steps
         agrees = is_followed(s, seed)
         steps = 2*steps
      end do
   end function agrees

   !> Lengths, singular position and beginning.
   subroutine throw_scene(d, s)
      type(dice_t), intent(inout) :: d
      type(scene_t), intent(out) :: s
      real(wp) :: cosine, away

      s%kind = throw(d, kinds_of)
      s%side = merge(1, -1, chance(d, 0.5_wp))
      away = between(d, 0.3_wp, 1.2_wp)*merge(1.0_wp, -1.0_wp, chance(d, 0.5_wp))
      do
         s%a = between(d, 0.4_wp, 2.0_wp)
         s%b = between(d, 0.4_wp, 3.0_wp)
         s%c = between(d, 0.4_wp, 3.0_wp)
         s%d = between(d, 0.4_wp, 3.0_wp)
         select case (s%kind)
         case (1, 2)
            ! Coupler and rocker in line, stretched: the crank goes no further.
            cosine = (s%a**2 + s%d**2 - (s%b + s%c)**2)/(2.0_wp*s%a*s%d)
            if (abs(cosine) > 0.95_wp) cycle
            s%singular = merge(1.0_wp, -1.0_wp, away > 0.0_wp)*acos(cosine)
            s%start = s%singular - away
            if (s%singular*s%start < 0.0_wp) cycle
         case (3)
            ! A parallelogram.
            if (abs(s%a - s%b) < 0.3_wp) cycle
            s%c = s%a
            s%d = s%b
            s%singular = pi
            s%start = s%singular - away
         case (4)
            ! A kite, stretched.
            if (abs(s%a - s%c) < 0.3_wp) cycle
            s%b = s%a
            s%d = s%c
            s%singular = pi
            s%start = s%singular - away
         case (kind_slider)
            ! Crank and rod of one length, on the line of the pivot: upright, the piston may stay there or go on.
            s%b = s%a
            s%d = 0.0_wp
            s%singular = 0.5_wp*pi
            s%start = s%singular - away
         case (kind_piston)
            ! Crank and rod stretched: the piston goes no further.
            if (s%d > 0.8_wp*(s%a + s%b)) cycle
            s%singular = sqrt((s%a + s%b)**2 - s%d**2)
            s%start = s%singular - abs(away)*min(0.5_wp, s%a, s%b, 0.5_wp*s%singular)
         end select
         if (dyad_sine(s, s%start) > 0.1_wp) exit
      end do
      s%goes_on = chance(d, 0.6_wp) .and. any(s%kind == [3, 4, kind_slider])
      s%has_card = chance(d, 0.4_wp)
   end subroutine throw_scene

   !> The mechanism of `s`, drawn at its beginning, and its drive: a rise by one of the four laws, a dwell and another
   !> rise.
   subroutine throw_rises(d, s)
      type(dice_t), intent(inout) :: d
      type(scene_t), intent(inout) :: s
      real(wp) :: lift, times(4)
      integer :: law

      lift = s%singular - s%start
      times = [0.5_wp, 2.0_wp, 4.0_wp, 2.0_wp]
      if (chance(d, 0.5_wp)) then
         times(1) = between(d, 0.0_wp, 1.0_wp)
         times(2) = between(d, 0.7_wp, 2.0_wp)
         times(3) = times(1) + times(2) + between(d, 0.1_wp, 2.0_wp)
         times(4) = between(d, 0.7_wp, 1.8_wp)
      end if
      law = term_cycloid + throw(d, 4) - 1
      if (s%kind >= kind_slider) then
         s%m = crank_slider(s%d)
         s%m%points(4)%offset(1) = s%a
         s%m%points(6)%offset(1) = s%b
      else
         s%m = four_bar()
         s%m%points(2)%offset(1) = s%d
         s%m%points(4)%offset(1) = s%a
         s%m%points(6)%offset(1) = s%b
         s%m%points(8)%offset(1) = s%c
      end if
      if (s%kind == kind_piston) then
         s%m%drives(1)%kind = drive_x
         s%m%drives(1)%subject = 7
      end if
      s%m%drives(1)%polynomial = [s%start, 0.0_wp, 0.0_wp]
      s%m%drives(1)%terms = [term_t(kind=law, r=[times(1), times(2), lift]), term_t(kind=law, r=[times(3), times(4), &
         merge(lift, -lift, s%goes_on)*between(d, 0.4_wp, 0.9_wp)])]
      if (s%has_card) s%m%branch_requests = [branch_request_t(t=times(merge(1, 3, chance(d, 0.5_wp)))*0.95_wp)]
      s%m%t0 = 0.0_wp
      s%m%t1 = 7.0_wp
      call find_links(s, s%start, s%side, s%m%links%position(1), s%m%links%position(2), s%m%links%position(3))
   end subroutine throw_rises

   !> Whether all instants of `s` have the positions of the closed form, and zero rates in the dwell.
   logical function is_followed(s, seed)
      type(scene_t), intent(in) :: s
      integer, intent(in) :: seed
      type(analysis_t) :: a
      type(motion_t) :: q
      type(drive_t) :: law
      real(wp) :: x(4), y(4), phi(4), f(3), off, sine, allowed, t
      integer :: k, side
      logical :: changes, stands

      is_followed = .true.
      call make_analysis(a, s%m)
      q = new_motion(4)
      law = s%m%drives(1)
      associate (rises => s%m%drives(1)%terms)
         ! A card for the way back, or one whose time is in the dwell, needs an instant there.
         changes = s%has_card
         stands = .false.
         do k = 0, merge(s%m%steps, -1, s%has_card)
            f = drive_motion(law, instant(s%m, k))
            off = abs(f(1) - s%singular)
            ! Whether an instant stands there that is hardly off is a matter of rounding.
            if (off > hardly_off(1) .and. off < hardly_off(2)) return
            stands = stands .or. off <= merge(at_place, at_place**2, any(s%kind == [3, 4, kind_slider]))
         end do
         if (changes) changes = stands .or. (s%goes_on .and. s%m%branch_requests(1)%t <= rises(1)%r(1) + rises(1)%r(2))
         do k = 0, s%m%steps
            t = instant(s%m, k)
            call advance(a, t, q)
            f = drive_motion(law, t)
            side = s%side
            if ((s%goes_on .neqv. changes) .and. t > rises(2)%r(1)) side = -side
            call find_links(s, f(1), side, x, y, phi)
            sine = dyad_sine(s, f(1))
            allowed = min(root, rounding/max(sine, epsilon(sine)))
            if (changes .and. q%known == 0 .and. t > rises(2)%r(1)) allowed = either
            off = max(maxval(abs(q%position(1, 2:) - x(2:))), maxval(abs(q%position(2, 2:) - y(2:))), &
               maxval(abs(wrap_angle(q%position(3, 2:) - phi(2:)))))
            is_followed = q%known >= 0 .and. off <= allowed
            if (t >= rises(1)%r(1) + rises(1)%r(2) .and. t < rises(2)%r(1)) is_followed = is_followed .and. &
               q%known == 2 .and. all(abs(q%velocity) <= 0.0_wp) .and. all(abs(q%acceleration) <= 0.0_wp)
            if (is_followed) cycle
            print '(4(a, i0), a, es9.2, a, es9.2)', ' SEED ', seed, ', KIND ', s%kind, ', INSTANT ', k, ' OF ', &
               s%m%steps, ': OFF BY ', off, ', MAY BE ', allowed
            return
         end do
      end associate
   end function is_followed

   !> The links (4) of `s` at the drive's value `v`, with the dyad on the given `side`.
   subroutine find_links(s, v, side, x, y, phi)
      type(scene_t), intent(in) :: s
      real(wp), intent(in) :: v
      integer, intent(in) :: side
      real(wp), intent(out) :: x(4), y(4), phi(4)
      real(wp) :: way(2), diagonal, cosine

      x = 0.0_wp
      y = 0.0_wp
      phi = 0.0_wp
      select case (s%kind)
      case (kind_slider)
         phi(2) = v
         x(3) = s%a*cos(v)
         y(3) = s%a*sin(v)
         ! The rod, turned as the crank's mirror image, or folded onto it.
         phi(3) = merge(-v, v + pi, side*cos(v) > 0.0_wp)
         x(4) = x(3) + s%b*cos(phi(3))
      case (kind_piston)
         diagonal = hypot(v, s%d)
         cosine = (s%a**2 + diagonal**2 - s%b**2)/(2.0_wp*s%a*diagonal)
         phi(2) = atan2(s%d, v) + side*acos(max(-1.0_wp, min(1.0_wp, cosine)))
         x(3) = s%a*cos(phi(2))
         y(3) = s%a*sin(phi(2))
         phi(3) = atan2(s%d - y(3), v - x(3))
         x(4) = v
         y(4) = s%d
      case default
         phi(2) = v
         x(3) = s%a*cos(v)
         y(3) = s%a*sin(v)
         way = [s%d - x(3), -y(3)]
         diagonal = norm2(way)
         cosine = (s%b**2 + diagonal**2 - s%c**2)/(2.0_wp*s%b*diagonal)
         phi(3) = atan2(way(2), way(1)) + side*acos(max(-1.0_wp, min(1.0_wp, cosine)))
         x(4) = s%d
         phi(4) = atan2(y(3) + s%b*sin(phi(3)), x(3) + s%b*cos(phi(3)) - s%d)
      end select
   end subroutine find_links

   !> The sine of the angle between the two links of the dyad, or of the rod and the normal of the guide.
   real(wp) function dyad_sine(s, v) result(sine)
      type(scene_t), intent(in) :: s
      real(wp), intent(in) :: v
      real(wp) :: x(4), y(4), phi(4)

      call find_links(s, v, s%side, x, y, phi)
      select case (s%kind)
      case (kind_slider)
         sine = abs(cos(phi(3)))
      case (kind_piston)
         sine = abs(sin(phi(2) - phi(3)))
      case default
         sine = abs(sin(phi(3) - phi(4)))
      end select
   end function dyad_sine
end program dwells_by_chance
