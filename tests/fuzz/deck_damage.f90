!> Tests. Changes of a deck that go to the limits of numbers and of structure, or damage its text; and the deck of a
!> seed.
module deck_damage
   use kinds, only: wp
   use dice, only: dice_t, new_dice, throw, chance
   use deck_text, only: deck_text_t, line_length, name_of, label, set_label, real_field, set_real, set_full, &
      insert_line, drop_line, find_cards, any_card, is_degrees, add_note
   use drawn_decks, only: drawn_deck
   use deck_mutations, only: prepare, change_gently, max_steps
   use deck_questions, only: ask, lengthen_names, write_in_polish
   implicit none
   private
   public :: deck_of_seed

   character(16), parameter :: extremes(*) = [character(16) :: '0.0', '-0.0', '1.0E308', '-1.0E308', &
      '1.797693134E308', '4.94066E-324', '1.0E-310', '2.22507385E-308', '1.0E-300', '-1.0E-160', '1.0E-20', '1.0E-9', &
      '1.0E8', '1.0E9', '1.0E16', '-1.0E20', '1.0E60', '1.1E60', '1.0E-60', '-1.0E-59', '1.0E35', '1.0', '90.0', &
      '180.0', '1.570796326794', '3.141592653589', '360.0', '0.5', '-1.0', '1.0E400', '1.0E-400', 'NAN', 'INF', '5', &
      '-', '1.5-3']
   character(8), parameter :: with_reals(*) = [character(8) :: 'GROUND', 'LINK', 'POINT', 'PRISM', 'SLOT', 'LENGTH', &
      'JOINT', 'CYLINDER', 'DRIVE', 'ADD', 'RISE', 'TIME', 'AT', 'METHOD', 'TOLER', 'VARY']
   character(8), parameter :: with_labels(*) = [character(8) :: 'GROUND', 'LINK', 'POINT', 'REVOLUTE', 'PRISM', &
      'SLOT', 'LENGTH', 'JOINT', 'CYLINDER', 'DRIVE', 'TIME', 'TOLER', 'VARY']
   !> Radians, or lengths: so far drives go in all; where extremes are searched, which takes longer.
   real(wp), parameter :: longest_way = 2000.0_wp, longest_search = 60.0_wp
   character(*), &
      parameter :: bytes = 'AZ09.+-*$ ,"'//'|eE'//achar(9)//achar(13)//achar(0)//achar(127)//char(195)//char(255)

contains

   !> The deck of seed number `seed`, made from one of `sets`, or a drawing of its own. Of ten decks seven are changed
   !> gently, two go to the limits, one is damaged, by a mixture of everything.
   function deck_of_seed(sets, seed) result(d)
      type(deck_text_t), intent(in) :: sets(:)
      integer, intent(in) :: seed
      type(deck_text_t) :: d
      type(dice_t) :: dice
      integer :: manner, i, n
      logical :: is_drawn

      dice = new_dice(seed)
      d = sets(throw(dice, size(sets)))
      is_drawn = chance(dice, 0.3_wp)
      d%dice = dice
      if (is_drawn) d = drawn_deck(dice)
      call prepare(d)
      manner = throw(d%dice, 10)
      n = merge(throw(d%dice, 2), throw(d%dice, 8), chance(d%dice, 0.6_wp))
      do i = 1, n
         call change_gently(d)
      end do
      if (chance(d%dice, 0.3_wp)) call ask(d)
      if (chance(d%dice, 0.1_wp)) call lengthen_names(d)
      if (chance(d%dice, 0.1_wp)) call write_in_polish(d)
      if (manner > 7) then
         do i = 1, throw(d%dice, 3)
            call change_to_limits(d)
         end do
      end if
      if (manner > 9) then
         do i = 1, throw(d%dice, 3)
            if (size(d%line) == 0) exit
            if (chance(d%dice, 0.3_wp)) then
               call slip(d)
            else
               call damage(d)
            end if
         end do
      end if
      call limit_steps(d)
      if (chance(d%dice, 0.97_wp)) call limit_way(d)
      do i = size(d%notes), 1, -1
         call insert_line(d, 1, '$ '//d%notes(i))
      end do
   end function deck_of_seed

   !> A deck that asks for very many steps says nothing more than one that asks for some.
   subroutine limit_steps(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i, n, status

      do i = 1, size(d%line)
         if (index(d%line(i), 'TIME') == 0) cycle
         read (d%line(i)(9:16), '(i8)', iostat=status) n
         if (status == 0 .and. n > max_steps) write (d%line(i)(9:16), '(i0)') max_steps
      end do
   end subroutine limit_steps

   !> Nor one whose drives go very far, which takes seconds: its times are brought nearer to zero, mostly.
   subroutine limit_way(d)
      type(deck_text_t), intent(inout) :: d
      integer, allocatable :: cards(:)
      integer :: i, k
      real(wp) :: t, rate, low, high, longest

      longest = merge(longest_search, longest_way, size(find_cards(d, ['EXTREMES'])) > 0)
      cards = find_cards(d, ['TIME    ', 'AT      '])
      ! A turn is a way of 2 pi, whatever the rate.
      do i = size(cards), 1, -1
         if (label(d%line(cards(i)), 2) /= 'TURNS') cycle
         if (real_field(d, cards(i), 2) > longest/6.3_wp) call set_real(d, cards(i), 2, longest/6.3_wp)
      end do
      cards = find_cards(d, ['TIME    ', 'AT      '])
      cards = pack(cards, [(label(d%line(cards(i)), 2) /= 'TURNS', i=1, size(cards))])
      t = 0.0_wp
      do i = 1, size(cards)
         do k = 1, merge(2, 3, name_of(d%line(cards(i))) == 'TIME')
            t = max(t, abs(real_field(d, cards(i), k)))
         end do
      end do
      if (t > 1.0e60_wp) return
      call find_fastest(d, t, rate)
      if (rate*t <= longest) return
      low = -60.0_wp
      high = log10(t)
      do i = 1, 40
         call find_fastest(d, 10.0_wp**(0.5_wp*(low + high)), rate)
         if (rate*10.0_wp**(0.5_wp*(low + high)) > longest) then
            high = 0.5_wp*(low + high)
         else
            low = 0.5_wp*(low + high)
         end if
      end do
      do i = size(cards), 1, -1
         do k = 1, merge(2, 3, name_of(d%line(cards(i))) == 'TIME')
            call set_real(d, cards(i), k, real_field(d, cards(i), k)*(10.0_wp**low/t))
         end do
      end do
      call add_note(d, 'WAY SHORTENED')
   end subroutine limit_way

   !> About the largest rate of any drive up to the time `t`.
   subroutine find_fastest(d, t, rate)
      type(deck_text_t), intent(in) :: d
      real(wp), intent(in) :: t
      real(wp), intent(out) :: rate
      integer :: i
      real(wp) :: r(3), unit

      unit = merge(0.02_wp, 1.0_wp, is_degrees(d))
      rate = 0.0_wp
      do i = 1, size(d%line)
         r = min([abs(real_field(d, i, 1)), abs(real_field(d, i, 2)), abs(real_field(d, i, 3))], 1.0e60_wp)
         if (name_of(d%line(i)) == 'DRIVE') then
            rate = max(rate, unit*(r(2) + r(3)*t))
         else if (name_of(d%line(i)) == 'ADD' .and. label(d%line(i), 1) == 'HARMONIC') then
            rate = max(rate, unit*r(1)*r(2))
         else if (name_of(d%line(i)) == 'RISE' .and. r(2) > 0.0_wp) then
            rate = max(rate, unit*2.0_wp*r(3)/r(2))
         else if (name_of(d%line(i)) == 'ADD' .and. label(d%line(i), 1) == 'POWER' .and. t > 0.0_wp) then
            rate = max(rate, unit*r(1)*r(2)*10.0_wp**min(60.0_wp, (r(2) - 1.0_wp)*log10(t)))
         end if
      end do
   end subroutine find_fastest

   !> One change to the limits of numbers or of structure.
   subroutine change_to_limits(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i, j, k

      select case (throw(d%dice, 11))
      case (1:4)
         i = any_card(d, with_reals)
         k = throw(d%dice, 3)
         if (i > 0) d%line(i)(16*k + 17:16*k + 32) = extremes(throw(d%dice, size(extremes)))
         if (i > 0) call add_note(d, 'EXTREME '//d%line(i)(1:16))
      case (5)
         i = any_card(d, with_labels)
         j = any_card(d, with_labels)
         if (i > 0) call set_label(d%line(i), throw(d%dice, 3), label(d%line(j), throw(d%dice, 3)))
         call add_note(d, 'LABELS EXCHANGED')
      case (6)
         i = throw(d%dice, size(d%line))
         if (name_of(d%line(i)) /= 'END') call drop_line(d, i)
         call add_note(d, 'CARD DROPPED')
      case (7)
         i = throw(d%dice, size(d%line))
         call insert_line(d, throw(d%dice, i), d%line(i))
         call add_note(d, 'CARD DOUBLED')
      case (8)
         i = any_card(d, ['POINT   '])
         j = any_card(d, ['POINT   '])
         if (i > 0) d%line(i)(33:) = d%line(j)(33:)
         call add_note(d, 'EQUAL POINTS')
      case (9)
         i = any_card(d, ['POINT   '])
         if (i > 0) call empty_link(d, label(d%line(i), 2))
      case (10)
         i = any_card(d, ['UNITS   '])
         if (i > 0) call set_label(d%line(i), 2, trim(merge('RAD', 'DEG', chance(d%dice, 0.5_wp))))
         call add_note(d, 'UNITS')
      case default
         i = any_card(d, with_reals)
         k = throw(d%dice, 3)
         if (i > 0) call set_full(d, i, k, 10.0_wp**(throw(d%dice, 600) - 300))
         if (i > 0) call add_note(d, 'MAGNITUDE OF '//d%line(i)(1:16))
      end select
   end subroutine change_to_limits

   !> All points of one link at its origin: a link without length.
   subroutine empty_link(d, link)
      type(deck_text_t), intent(inout) :: d
      character(*), intent(in) :: link
      integer :: i

      do i = 1, size(d%line)
         if (name_of(d%line(i)) == 'POINT' .and. label(d%line(i), 2) == link) d%line(i)(33:) = ''
      end do
      call add_note(d, 'NO LENGTH '//link)
   end subroutine empty_link

   !> One damage of the text.
   subroutine damage(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i, j, c, k
      character(line_length) :: line

      i = throw(d%dice, size(d%line))
      j = throw(d%dice, size(d%line))
      c = throw(d%dice, 80)
      k = throw(d%dice, len(bytes))
      line = d%line(i)
      select case (throw(d%dice, 12))
      case (1); d%line(i)(c:c) = bytes(k:k)
      case (2); d%line(i) = line(:c - 1)//line(c + 1:)
      case (3); d%line(i) = line(:c - 1)//bytes(k:k)//line(c:)
      case (4); d%line(i) = line(:c)
      case (5); d%line(i)(c + 60:) = 'PAST THE END'
      case (6); d%line([i, j]) = d%line([j, i])
      case (7)
         c = throw(d%dice, 9)
         c = merge(8*c - 7, 16*c - 47, c < 5)
         d%line(i)(c:c + 15) = d%line(j)(c:c + 15)
      case (8)
         ! The name of the card, or the labels too.
         c = merge(8, 32, c < 40)
         d%line(i)(:c) = lower(line(:c))
      case (9); d%line(i) = trim(line)//achar(13)
      case (10); d%line = d%line(:i)
      case (11); call insert_line(d, i, d%line(j))
      case default; call drop_line(d, i)
      end select
      call add_note(d, 'TEXT DAMAGED')
   end subroutine damage

   !> One slip of a new user: a decimal comma, numbers that touch, a name with one letter wrong or of nine letters, text
   !> in the wrong columns, or the whole deck in free format.
   subroutine slip(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i, k, c

      i = throw(d%dice, size(d%line))
      associate (line => d%line(i))
         select case (throw(d%dice, 8))
         case (1)
            c = index(line(33:80), '.')
            if (c > 0) line(32 + c:32 + c) = ','
         case (2)
            c = merge(33, 49, chance(d%dice, 0.5_wp))
            line(c:c + 16 + throw(d%dice, 8)) = '0.52359877559829910.000000'
         case (3:5)
            ! A letter of the name of the card or of a label: wrong, left out, added, or exchanged with the next one.
            k = 8*throw(d%dice, 4)
            c = k - 8 + throw(d%dice, max(1, len_trim(line(k - 7:k))))
            select case (throw(d%dice, 4))
            case (1)
               line(c:c) = 'Q'
            case (2)
               line(c:k) = line(c + 1:k)
            case (3)
               line(c:k) = 'Q'//line(c:k - 1)
            case default
               line(c:min(c + 1, k)) = line(min(c + 1, k):min(c + 1, k))//line(c:c)
            end select
         case (6)
            k = 8*throw(d%dice, 3)
            line = line(:k)//'NINELETRS'//line(k + 8 + throw(d%dice, 2):)
         case (7)
            c = 8*throw(d%dice, 9)
            line = line(:c)//repeat(' ', throw(d%dice, 16))//line(c + 1:)
         case default
            do i = 1, size(d%line)
               d%line(i) = single_blanks(trim(d%line(i)))
            end do
         end select
      end associate
      call add_note(d, 'A SLIP')
   end subroutine slip

   !> `text` with one blank for several.
   pure function single_blanks(text) result(short)
      character(*), intent(in) :: text
      character(:), allocatable :: short
      integer :: i

      short = ''
      do i = 1, len(text)
         if (text(i:i) /= ' ' .or. text(max(1, i - 1):max(1, i - 1)) /= ' ') short = short//text(i:i)
      end do
   end function single_blanks

   pure function lower(text) result(small)
      character(*), intent(in) :: text
      character(len(text)) :: small
      integer :: i

      small = text
      do i = 1, len(text)
         if (text(i:i) >= 'A' .and. text(i:i) <= 'Z') small(i:i) = achar(iachar(text(i:i)) + 32)
      end do
   end function lower
end module deck_damage
