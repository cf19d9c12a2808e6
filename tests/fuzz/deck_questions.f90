!> Tests. Cards that ask something of a deck's motion, or change what it is called: answers, variants, tolerances,
!> names as long as they may be, the listing in Polish.
module deck_questions
   use kinds, only: wp
   use dice, only: throw, chance, between
   use deck_text, only: deck_text_t, name_of, label, set_label, real_field, insert_line, line_behind, find_cards, &
      any_card, add_note
   implicit none
   private
   public :: ask, lengthen_names, write_in_polish

   character(8), parameter :: with_dimensions(*) = [character(8) :: 'LINK', 'POINT', 'PRISM', 'SLOT', 'JOINT', &
      'LENGTH', 'DRIVE', 'CYLINDER', 'TIME']
   !> Circuits are asked of so many links at most.
   integer, parameter :: most_links = 5

contains

   !> One more card that asks for something.
   subroutine ask(d)
      type(deck_text_t), intent(inout) :: d
      character(8), parameter :: plain(*) = [character(8) :: 'RANGE', 'CIRCUITS', 'ASSEMBLY', 'PROVE']
      character(8), parameter :: kinds(*) = [character(8) :: 'ALL', 'LINKS', 'POINTS', 'PAIRS', 'MEASURES']
      character(8), parameter :: column_kinds(*) = [character(8) :: 'LINKS', 'POINTS', 'PAIRS', 'RATIOS', 'MEASURES']
      character(8), parameter :: quantities(*) = [character(8) :: 'X', 'VY', 'PHI', 'APHI', 'VALUE', 'AVALUE', 'DERIV']
      character(80) :: card

      card = ''
      select case (throw(d%dice, 14))
      case (1:4)
         card = plain(throw(d%dice, size(plain)))
         ! The circuits of many links can take minutes.
         if (card == 'CIRCUITS' .and. size(find_cards(d, ['LINK    '])) > most_links) return
      case (5:6)
         card = 'EXTREMES'//kinds(throw(d%dice, size(kinds)))
         if (chance(d%dice, 0.3_wp)) &
            write (card(33:64), '(2es16.8e3)') between(d%dice, 0.0_wp, 1.0_wp), between(d%dice, 0.0_wp, 9.0_wp)
      case (7)
         card = 'POLE    '//any_name(d, ['GROUND  ', 'LINK    '])//any_name(d, ['GROUND  ', 'LINK    '])
      case (8)
         card = 'CURVE   '//any_name(d, ['POINT   '])//any_name(d, ['GROUND  ', 'LINK    '])
      case (9)
         card = 'BRANCH'
         if (chance(d%dice, 0.5_wp)) card(9:16) = any_name(d, ['LINK    '])
         write (card(33:48), '(es16.8e3)') between(d%dice, 0.0_wp, 10.0_wp)
      case (10)
         card = 'COLUMN  '//column_kinds(throw(d%dice, size(column_kinds)))
         if (card(9:16) == 'LINKS') card(17:24) = any_name(d, ['LINK    '])
         if (card(9:16) == 'POINTS') card(17:24) = any_name(d, ['POINT   ', 'JOINT   '])
         if (any(card(9:16) == column_kinds(3:))) card(17:24) = any_pair(d)
         if (chance(d%dice, 0.5_wp)) card(25:32) = quantities(throw(d%dice, size(quantities)))
      case (11)
         card = merge('PRINT   ', 'EXTREMES', chance(d%dice, 0.7_wp))//'RATIOS'
         if (chance(d%dice, 0.5_wp)) card(17:24) = any_pair(d)
      case (12:13)
         card = a_measure(d)
      case default
         if (chance(d%dice, 0.5_wp)) call vary(d)
         if (chance(d%dice, 0.5_wp)) call tolerate(d)
      end select
      if (card == '') return
      call insert_line(d, last_line(d), card)
      call add_note(d, 'ASKED: '//card(:24))
   end subroutine ask

   !> A card that measures something, with a name of its own.
   function a_measure(d) result(card)
      type(deck_text_t), intent(inout) :: d
      character(80) :: card
      character(8), parameter :: cards(*) = [character(8) :: 'DISTANCE', 'LINE', 'ANGLE', 'XI', 'ETA', 'SUM']
      character(8), parameter :: links(2) = ['GROUND  ', 'LINK    '], points(2) = ['POINT   ', 'JOINT   ']
      character(8) :: name

      card = cards(throw(d%dice, size(cards)))
      write (name, '(a, i0)') 'M', size(find_cards(d, cards)) + 1
      select case (card)
      case ('DISTANCE', 'LINE')
         card(9:24) = any_name(d, points)//any_name(d, points)
      case ('XI', 'ETA')
         card(9:24) = any_name(d, points)//any_name(d, links)
      case ('ANGLE')
         card(9:16) = any_name(d, links)
         card(17:24) = any_name(d, links)
         if (chance(d%dice, 0.5_wp)) card(9:16) = any_name(d, ['LINE    '], 3)
      case default
         card(9:16) = any_name(d, cards(:5), 3)
         if (chance(d%dice, 0.5_wp)) card(17:24) = any_name(d, cards, 3)
         if (chance(d%dice, 0.5_wp)) write (card(33:48), '(es16.8e3)') between(d%dice, -2.0_wp, 2.0_wp)
      end select
      card(25:32) = name
   end function a_measure

   !> The line of the END card, or the one behind the last.
   integer function last_line(d)
      type(deck_text_t), intent(in) :: d

      do last_line = size(d%line), 1, -1
         if (name_of(d%line(last_line)) == 'END') return
      end do
      last_line = size(d%line) + 1
   end function last_line

   !> What one of the `cards` is about, as its first label says, or label number `place`.
   function any_name(d, cards, place) result(name)
      type(deck_text_t), intent(inout) :: d
      character(8), intent(in) :: cards(:)
      integer, intent(in), optional :: place
      character(8) :: name
      integer :: i, k

      name = ''
      k = 1
      if (present(place)) k = place
      i = any_card(d, cards)
      if (i > 0) name = label(d%line(i), k)
   end function any_name

   !> The name of a pair.
   function any_pair(d) result(name)
      type(deck_text_t), intent(inout) :: d
      character(8) :: name
      integer :: i

      name = ''
      i = any_card(d, ['REVOLUTE', 'PRISM   ', 'SLOT    ', 'CYLINDER', 'JOINT   '])
      if (i > 0) name = label(d%line(i), merge(1, 3, name_of(d%line(i)) == 'JOINT'))
   end function any_pair

   !> A few values for a number of a card.
   subroutine vary(d)
      type(deck_text_t), intent(inout) :: d
      character(80) :: card
      real(wp) :: x, size_of
      integer :: i, k

      i = any_card(d, with_dimensions)
      if (i == 0) return
      k = throw(d%dice, 3)
      x = real_field(d, i, k)
      size_of = between(d%dice, -0.3_wp, 0.3_wp)*max(abs(x), 1.0e-3_wp)
      if (abs(x) > 1.0e60_wp) return
      write (card, '(a,i0,t17,i0,t33,2es16.8e3)') 'VARY    R', k, throw(d%dice, 20), x - size_of, x + size_of
      call insert_line(d, line_behind(d, i), card)
      call add_note(d, 'VARIED: '//d%line(i)(:16))
   end subroutine vary

   !> Tolerances of a card's numbers.
   subroutine tolerate(d)
      type(deck_text_t), intent(inout) :: d
      character(80) :: card
      integer :: i, k

      i = any_card(d, with_dimensions(2:6))
      if (i == 0) return
      card = 'TOLER'
      if (name_of(d%line(i)) == 'JOINT' .and. chance(d%dice, 0.4_wp)) &
         card(9:16) = merge('BOTH    ', label(d%line(i), 1 + throw(d%dice, 2)), chance(d%dice, 0.5_wp))
      do k = 1, merge(3, 2, name_of(d%line(i)) == 'PRISM')
         if (chance(d%dice, 0.6_wp)) write (card(16*k + 17:16*k + 32), '(es16.8e3)') between(d%dice, 0.0_wp, 0.1_wp)
      end do
      call insert_line(d, line_behind(d, i), card)
      call add_note(d, 'TOLERANCES: '//d%line(i)(:16))
   end subroutine tolerate

   !> All names of links, points and pairs get the length of a field.
   subroutine lengthen_names(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i, k

      do i = 1, size(d%line)
         do k = 1, 3
            if (is_name(d%line(i), k)) call set_label(d%line(i), k, trim(label(d%line(i), k))//repeat('W', 8))
         end do
      end do
      call add_note(d, 'LONG NAMES')
   end subroutine lengthen_names

   !> Label `k` of the card `line` is the name of a link, point or pair.
   pure logical function is_name(line, k)
      character(*), intent(in) :: line
      integer, intent(in) :: k

      select case (name_of(line))
      case ('GROUND', 'BRANCH')
         is_name = k == 1
      case ('POINT', 'POLE', 'CURVE')
         is_name = k <= 2
      case ('LINK', 'REVOLUTE', 'PRISM', 'SLOT', 'CYLINDER', 'LENGTH', 'JOINT', 'DISTANCE', 'LINE', 'ANGLE', 'XI', &
         'ETA', 'SUM')
         is_name = .true.
      case ('DRIVE')
         is_name = k >= 2 .and. label(line, k) /= 'RPM'
      case ('PRINT', 'COLUMN', 'EXTREMES')
         is_name = k == 2
      case default
         is_name = .false.
      end select
      is_name = is_name .and. label(line, k) /= ''
   end function is_name

   !> The listing's headings in Polish.
   subroutine write_in_polish(d)
      type(deck_text_t), intent(inout) :: d

      if (size(find_cards(d, ['LANG    '])) == 0) call insert_line(d, last_line(d), 'LANG    PL')
   end subroutine write_in_polish
end module deck_questions
