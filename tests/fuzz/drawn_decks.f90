!> Tests. Decks drawn by chance, with JOINT cards: a crank, a boom on its cylinder, or a parallelogram of three bars in
!> rounded coordinates, and groups of links on it. Bars have lengths and axes along them, cylinders have strokes, pins
!> run in slots, holes and lengths have tolerances, and runs may count turns.
module drawn_decks
   use kinds, only: wp
   use dice, only: dice_t, throw, chance, between, magnitude
   use plane_vectors, only: pi
   use deck_text, only: deck_text_t, line_length, label, set_label, insert_line, find_cards
   use printed_cards, only: row
   implicit none
   private
   public :: drawn_deck

   type, extends(deck_text_t) :: drawing_t
      character(8), allocatable :: links(:)      !< names; the first is the ground
      real(wp) :: size_of = 1.0_wp               !< of the mechanism
      real(wp) :: turn = 2.0_wp*pi               !< in the deck's unit of angles
      integer :: names = 0                       !< so many joints, points and pairs have names
      logical :: counts_turns = .false.          !< its one drive turns a link at a constant rate
   end type drawing_t

contains

   !> A deck by the `dice`, which it keeps.
   function drawn_deck(dice) result(d)
      type(dice_t), intent(in) :: dice
      type(deck_text_t) :: d
      type(drawing_t) :: w
      integer :: k

      w%dice = dice
      allocate (w%line(0))
      w%notes = [character(line_length) :: 'DRAWN']
      w%links = ['BASE    ']
      w%size_of = 10.0_wp**throw(w%dice, 3)/10.0_wp
      if (chance(w%dice, 0.5_wp)) w%turn = 360.0_wp
      call add_card(w, 'UNITS', 'MM', trim(merge('DEG', 'RAD', w%turn > 100.0_wp)), 'S')
      call add_card(w, 'GROUND', 'BASE')
      select case (throw(w%dice, 10))
      case (1:5)
         call draw_crank(w)
      case (6:8)
         call draw_boom(w)
      case default
         call draw_parallelogram(w)
      end select
      do k = 1, throw(w%dice, 3) - 1
         select case (throw(w%dice, 8))
         case (1:3)
            call draw_dyad(w)
         case (4:5)
            call draw_cylinder(w, other_link(w, ''), other_link(w, 'BASE'), anywhere(w), anywhere(w))
         case (6:7)
            call draw_slot(w)
         case default
            call draw_slider(w)
         end select
      end do
      call draw_instants(w)
      call add_card(w, 'PRINT', 'ALL')
      call add_card(w, 'END')
      d = w%deck_text_t
   end function drawn_deck

   !> A crank that turns, as drawn or from any angle.
   subroutine draw_crank(w)
      type(drawing_t), intent(inout) :: w
      real(wp) :: p(2), q(2)
      character(8) :: crank, tip, joint(2)

      p = anywhere(w)
      q = p + 0.4_wp*(anywhere(w) - p)
      crank = new_link(w)
      tip = new_link(w)
      joint(1) = new_joint(w, 'BASE', crank, p)
      joint(2) = new_joint(w, crank, tip, q)
      call draw_bar(w, crank, joint, q - p)
      ! The link at the tip slides in a slot of the ground.
      call draw_pin(w, 'BASE', tip)
      call drive_angle(w, crank)
   end subroutine draw_crank

   !> A boom, which its cylinder drives.
   subroutine draw_boom(w)
      type(drawing_t), intent(inout) :: w
      character(8) :: boom, pair, pivot
      real(wp) :: rate

      boom = new_link(w)
      pivot = new_joint(w, 'BASE', boom, anywhere(w))
      call draw_cylinder(w, 'BASE', boom, anywhere(w), anywhere(w), pair)
      rate = w%size_of*between(w%dice, -0.5_wp, 0.5_wp)
      if (chance(w%dice, 0.8_wp)) call add_card(w, 'DRIVE', 'SLIDE', pair, x2=rate)
      if (size(find_cards(w%deck_text_t, ['DRIVE   '])) == 0) &
         call add_card(w, 'DRIVE', 'SLIDE', pair, x1=w%size_of*between(w%dice, -0.2_wp, 2.5_wp), x2=rate)
   end subroutine draw_boom

   !> Three equal bars on a coupler, drawn in coordinates that are rounded; a closing tolerance lets them run.
   subroutine draw_parallelogram(w)
      type(drawing_t), intent(inout) :: w
      character(8) :: coupler, bar, joint(2), method(3)
      real(wp) :: arm(2), foot(2), rounded
      integer :: k

      rounded = w%size_of*0.001_wp
      coupler = new_link(w)
      arm = anywhere(w)
      do k = 1, 3
         bar = new_link(w)
         foot = rounded*anint(anywhere(w)/rounded)
         joint(1) = new_joint(w, 'BASE', bar, foot)
         joint(2) = new_joint(w, bar, coupler, rounded*anint((foot + arm)/rounded))
         call draw_bar(w, bar, joint, arm)
         if (k == 1) call drive_angle(w, bar)
      end do
      method = [character(8) :: 'DENSE', 'NEWTON', '']
      k = min(3, throw(w%dice, 20))
      call add_card(w, 'METHOD', method(k))
      if (k > 1 .and. chance(w%dice, 0.9_wp)) &
         write (w%line(size(w%line))(49:64), '(es16.8e3)') 10.0_wp**between(w%dice, -4.0_wp, -2.0_wp)
   end subroutine draw_parallelogram

   !> Two bars between two links.
   subroutine draw_dyad(w)
      type(drawing_t), intent(inout) :: w
      character(8) :: one, other, joint(3)
      real(wp) :: p(2, 3)
      integer :: k

      do k = 1, 3
         p(:, k) = anywhere(w)
      end do
      joint(1) = other_link(w, '')
      joint(3) = other_link(w, 'BASE')
      one = new_link(w)
      other = new_link(w)
      joint(1) = new_joint(w, joint(1), one, p(:, 1))
      joint(3) = new_joint(w, other, joint(3), p(:, 3))
      joint(2) = new_joint(w, one, other, p(:, 2))
      call draw_bar(w, one, joint(:2), p(:, 2) - p(:, 1))
      call draw_bar(w, other, [joint(3), joint(2)], p(:, 2) - p(:, 3))
   end subroutine draw_dyad

   !> A cylinder from a joint at `p` on the link `base` to one at `q` on `link`; `pair`: its name.
   subroutine draw_cylinder(w, base, link, p, q, pair)
      type(drawing_t), intent(inout) :: w
      character(*), intent(in) :: base, link
      real(wp), intent(in) :: p(2), q(2)
      character(8), intent(out), optional :: pair
      character(8) :: barrel, rod, foot, eye, name
      real(wp) :: length

      barrel = new_link(w)
      rod = new_link(w)
      foot = new_joint(w, barrel, base, p)
      eye = new_joint(w, rod, link, q)
      length = norm2(q - p)
      name = new_name(w, 'RAM')
      select case (throw(w%dice, 4))
      case (1)
         call add_card(w, 'CYLINDER', foot, eye, name)
      case (2)
         call add_card(w, 'CYLINDER', foot, eye, name, x1=length*between(w%dice, 0.5_wp, 1.02_wp))
      case (3)
         call add_card(w, 'CYLINDER', foot, eye, name, x2=length*between(w%dice, 0.98_wp, 1.6_wp))
      case default
         call add_card(w, 'CYLINDER', foot, eye, name, length*between(w%dice, 0.5_wp, 1.0_wp), &
            length*between(w%dice, 1.0_wp, 1.6_wp))
      end select
      if (present(pair)) pair = name
   end subroutine draw_cylinder

   !> A link on a joint, with a pin in a slot of another one, or a slot for a pin of it.
   subroutine draw_slot(w)
      type(drawing_t), intent(inout) :: w
      character(8) :: one, other, arm, joint

      one = other_link(w, '')
      other = other_link(w, 'BASE')
      arm = new_link(w)
      joint = new_joint(w, arm, one, anywhere(w))
      if (chance(w%dice, 0.5_wp)) then
         call draw_pin(w, arm, other)
      else
         call draw_pin(w, other, arm)
      end if
   end subroutine draw_slot

   !> A point of `link` in a slot of `base`.
   subroutine draw_pin(w, base, link)
      type(drawing_t), intent(inout) :: w
      character(*), intent(in) :: base, link
      character(8) :: p, q, name

      p = new_point(w, base)
      q = new_point(w, link)
      name = new_name(w, 'S')
      call add_card(w, 'SLOT', p, q, name, w%turn*between(w%dice, -0.5_wp, 0.5_wp))
      if (chance(w%dice, 0.2_wp)) &
         write (w%line(size(w%line))(49:64), '(f16.4)') w%size_of*between(w%dice, -0.2_wp, 0.2_wp)
      call change_later(w, 'SLOT', '')
   end subroutine draw_pin

   !> A rod on a block, whose guide another link has.
   subroutine draw_slider(w)
      type(drawing_t), intent(inout) :: w
      character(8) :: base, link, rod, block, ends(2), point, guide
      real(wp) :: p(2), q(2)

      base = other_link(w, '')
      link = other_link(w, 'BASE')
      rod = new_link(w)
      block = new_link(w)
      p = anywhere(w)
      q = anywhere(w)
      ends(1) = new_joint(w, rod, link, p)
      ends(2) = new_joint(w, block, rod, q)
      call draw_bar(w, rod, ends, q - p)
      point = new_point(w, base)
      guide = new_name(w, 'G')
      call add_card(w, 'PRISM', point, ends(2), guide, w%turn*between(w%dice, -0.5_wp, 0.5_wp))
   end subroutine draw_slider

   !> Axes and a length along the bar of `link`, each by chance.
   subroutine draw_bar(w, link, joint, way)
      type(drawing_t), intent(inout) :: w
      character(*), intent(in) :: link
      character(8), intent(in) :: joint(2)        !< its ends
      real(wp), intent(in) :: way(2)              !< from the first to the second one in the drawing
      integer, allocatable :: cards(:)
      integer :: k

      if (chance(w%dice, 0.5_wp)) then
         cards = find_cards(w%deck_text_t, ['LINK    '])
         do k = 1, size(cards)
            if (label(w%line(cards(k)), 1) /= link) cycle
            call set_label(w%line(cards(k)), 2, joint(1))
            call set_label(w%line(cards(k)), 3, joint(2))
            if (chance(w%dice, 0.2_wp)) &
               write (w%line(cards(k))(65:80), '(f16.4)') w%turn*between(w%dice, -0.5_wp, 0.5_wp)
         end do
      end if
      if (chance(w%dice, 0.4_wp)) return
      call add_card(w, 'LENGTH', joint(1), joint(2), merge(link, repeat(' ', len(link)), chance(w%dice, 0.1_wp)), &
         norm2(way)*between(w%dice, 0.95_wp, 1.05_wp))
      call change_later(w, 'LENGTH', '')
   end subroutine draw_bar

   !> TOLER or VARY below the card in hand, by chance; `link`: one of those of a joint.
   subroutine change_later(w, name, link)
      type(drawing_t), intent(inout) :: w
      character(*), intent(in) :: name, link
      character(8) :: whose(3)

      whose = [character(8) :: link, 'BOTH', '']
      if (name /= 'JOINT') whose = ''
      if (chance(w%dice, 0.15_wp)) call add_card(w, 'TOLER', whose(throw(w%dice, 3)), &
         x1=0.01_wp*w%size_of*between(w%dice, 0.0_wp, 1.0_wp))
      if (chance(w%dice, 0.01_wp)) call add_card(w, 'VARY', 'R1', '3', x1=w%size_of*between(w%dice, 0.0_wp, 2.0_wp), &
         x2=w%size_of*between(w%dice, 0.0_wp, 2.0_wp))
   end subroutine change_later

   !> The angle of `link` is driven, from the drawing or from any angle.
   subroutine drive_angle(w, link)
      type(drawing_t), intent(inout) :: w
      character(*), intent(in) :: link
      real(wp) :: rate

      rate = w%turn*between(w%dice, 0.05_wp, 0.5_wp)
      if (chance(w%dice, 0.5_wp)) rate = -rate
      if (chance(w%dice, 0.2_wp)) then
         call add_card(w, 'DRIVE', 'RELANGLE', 'BASE', link, x2=rate)
      else if (chance(w%dice, 0.3_wp)) then
         call add_card(w, 'DRIVE', 'ANGLE', link, x1=w%turn*between(w%dice, -0.5_wp, 0.5_wp), x2=rate)
      else
         call add_card(w, 'DRIVE', 'ANGLE', link, merge('RPM', '   ', chance(w%dice, 0.1_wp)), x2=rate)
      end if
      w%counts_turns = .true.
   end subroutine drive_angle

   !> A run over time, or over turns of the drive.
   subroutine draw_instants(w)
      type(drawing_t), intent(inout) :: w
      character(8) :: steps

      write (steps, '(i0)') throw(w%dice, 12)
      if (w%counts_turns .and. chance(w%dice, 0.5_wp)) then
         call add_card(w, 'TIME', steps, 'TURNS', x1=anint(between(w%dice, -1.0_wp, 1.0_wp)), &
            x2=between(w%dice, 0.01_wp, 2.0_wp))
         if (chance(w%dice, 0.05_wp)) call add_card(w, 'VARY', 'R2', '3', x1=0.5_wp, x2=1.5_wp)
      else
         call add_card(w, 'TIME', steps, x1=0.0_wp, x2=between(w%dice, -1.0_wp, 3.0_wp))
      end if
      if (chance(w%dice, 0.2_wp)) call add_card(w, 'AT', x1=0.0_wp, x2=between(w%dice, 0.0_wp, 1.0_wp))
   end subroutine draw_instants

   !> A place of the drawing.
   function anywhere(w) result(p)
      type(drawing_t), intent(inout) :: w
      real(wp) :: p(2)

      p(1) = w%size_of*between(w%dice, -2.0_wp, 2.0_wp)
      p(2) = w%size_of*between(w%dice, -2.0_wp, 2.0_wp)
   end function anywhere

   !> A link by chance, but not `but`.
   function other_link(w, but) result(name)
      type(drawing_t), intent(inout) :: w
      character(*), intent(in) :: but
      character(8) :: name

      do
         name = w%links(throw(w%dice, size(w%links)))
         if (name /= but) return
      end do
   end function other_link

   function new_name(w, first) result(name)
      type(drawing_t), intent(inout) :: w
      character(*), intent(in) :: first
      character(8) :: name

      w%names = w%names + 1
      write (name, '(a, i0)') first, w%names
   end function new_name

   function new_link(w) result(name)
      type(drawing_t), intent(inout) :: w
      character(8) :: name

      name = new_name(w, 'L')
      w%links = [w%links, name]
      call add_card(w, 'LINK', name)
   end function new_link

   !> A joint of two links at `p`.
   function new_joint(w, one, other, p) result(name)
      type(drawing_t), intent(inout) :: w
      character(*), intent(in) :: one, other
      real(wp), intent(in) :: p(2)
      character(8) :: name

      name = new_name(w, 'J')
      call add_card(w, 'JOINT', name, one, other, p(1), p(2))
      call change_later(w, 'JOINT', other)
   end function new_joint

   !> A point of `link`.
   function new_point(w, link) result(name)
      type(drawing_t), intent(inout) :: w
      character(*), intent(in) :: link
      character(8) :: name
      real(wp) :: p(2)

      name = new_name(w, 'P')
      p = anywhere(w)
      call add_card(w, 'POINT', name, link, x1=p(1), x2=p(2))
      call change_later(w, 'POINT', '')
   end function new_point

   subroutine add_card(w, name, a, b, c, x1, x2)
      type(drawing_t), intent(inout) :: w
      character(*), intent(in) :: name
      character(*), intent(in), optional :: a, b, c
      real(wp), intent(in), optional :: x1, x2
      character(80) :: card

      card = row(name, a, b, c)
      if (present(x1)) write (card(33:48), '(f16.4)') x1
      if (present(x2)) write (card(49:64), '(f16.4)') x2
      call insert_line(w%deck_text_t, size(w%line) + 1, card)
   end subroutine add_card
end module drawn_decks
