!> What the documents say of messages and of the fields of cards, as lines for a terminal: --explain, --ruler CARD.
module explanations
   use failures, only: capitals
   use document_texts, only: message_cell, message_count, field_cell, field_count
   implicit none
   private
   public :: explained, explained_fields

   character(1), parameter :: nl = new_line('a')
   integer, parameter :: columns = 80
   !> A printed message is known by its words, if these have more letters than LINKS and one name.
   integer, parameter :: known_length = 14

contains

   !> Gives the entries of docs/messages.md that `words` ask for, or '' if there are none: the entries of the code in
   !> `words`. Without a code, those whose message holds the words; otherwise those of the printed message `words`.
   pure function explained(words) result(text)
      character(*), intent(in) :: words
      character(:), allocatable :: text
      character(:), allocatable :: key
      integer :: i, best
      integer :: scores(message_count)

      text = ''
      key = single_blanks(capitals(words))
      if (len(key) == 0) return
      scores = 0
      do i = 1, message_count
         if (has_code(message_cell(i, 1), key)) scores(i) = 1
      end do
      if (all(scores == 0)) then
         do i = 1, message_count
            if (index(capitals(without_marks(message_cell(i, 2))), key) > 0) scores(i) = 1
         end do
      end if
      if (all(scores == 0)) scores = [(likeness(message_cell(i, 2), key), i=1, message_count)]
      best = maxval(scores)
      do i = 1, message_count
         if (best == 0 .or. scores(i) < best) cycle
         if (len(text) > 0) text = text//nl//nl
         text = text//entry(i)
      end do
   end function explained

   !> Gives a line or more for each field of the cards of the name `card`, in capitals: contents, type, default, unit.
   pure function explained_fields(card) result(text)
      character(*), intent(in) :: card
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, field_count
         if (field_cell(i, 1) /= card) cycle
         if (len(text) > 0) text = text//nl
         text = text//folded(padded(capitals(field_cell(i, 2)), 9), field_cell(i, 3)//': '//field_cell(i, 4) &
            //default_of(field_cell(i, 5))//unit_of(field_cell(i, 6)), 9)
      end do
      if (len(text) == 0) text = 'This card has no fields.'

   contains

      !> The default as a further part of the line; a field that must not be blank has none.
      pure function default_of(cell) result(part)
         character(*), intent(in) :: cell
         character(:), allocatable :: part

         part = '; default: '//cell
         if (cell == 'required') part = '; required'
      end function default_of

      !> The unit as a further part of the line, if there is one.
      pure function unit_of(cell) result(part)
         character(*), intent(in) :: cell
         character(:), allocatable :: part

         part = ''
         if (len(cell) > 0) part = '; unit: '//cell
      end function unit_of
   end function explained_fields

   !> The lines of message `i`: code and message, cause, cure.
   pure function entry(i) result(text)
      integer, intent(in) :: i
      character(:), allocatable :: text

      text = folded(padded(message_cell(i, 1), 7), without_marks(message_cell(i, 2)), 7)
      if (len(message_cell(i, 3)) > 0) text = text//nl//folded('       CAUSE  ', message_cell(i, 3), 14)
      text = text//nl//folded('       CURE   ', message_cell(i, 4), 14)
   end function entry

   !> `key` has a code of `codes`, which are separated by a comma and a blank.
   pure logical function has_code(codes, key)
      character(*), intent(in) :: codes, key
      integer :: first

      has_code = .false.
      do first = 1, len(codes) - 3, 6
         has_code = has_code .or. index(' '//key//' ', ' '//codes(first:first + 3)//' ') > 0
      end do
   end function has_code

   !> How many letters of a printed message are words of `message`, all of which it must have in their order; else 0.
   !> An alternative of `message` stands between marks `; words with ... and single small letters stand for others.
   pure integer function likeness(message, key) result(letters)
      character(*), intent(in) :: message, key
      integer :: from, to

      letters = 0
      from = 1
      if (index(message, '`') == 0) letters = likeness_of(message)
      do
         to = index(message(from:), '`')
         if (to == 0) exit
         from = from + to
         to = from + index(message(from:), '`') - 2
         letters = max(letters, likeness_of(message(from:to)))
         from = to + 2
      end do
      if (letters < known_length) letters = 0

   contains

      !> How many letters of the key are words of one alternative.
      pure integer function likeness_of(alternative) result(letters)
         character(*), intent(in) :: alternative
         integer :: first, last, place, found

         letters = 0
         first = 1
         place = 1
         do while (first <= len(alternative))
            last = index(alternative(first:)//' ', ' ') + first - 2
            associate (word => alternative(first:last))
               first = last + 2
               if (index(word, '...') > 0) cycle
               if (len(word) == 1 .and. word >= 'a' .and. word <= 'z') cycle
               found = index(key(place:), capitals(word))
               if (found == 0) then
                  letters = 0
                  return
               end if
               letters = letters + len(word)
               place = place + found - 1 + len(word)
            end associate
         end do
      end function likeness_of
   end function likeness

   !> `text` behind `head`, in lines of at most 80 columns, the further ones indented by `indent`.
   pure function folded(head, text, indent) result(lines)
      character(*), intent(in) :: head, text
      integer, intent(in) :: indent
      character(:), allocatable :: lines
      integer :: first, last, before

      lines = head
      before = len(head)
      first = 1
      do
         last = len(text)
         if (before + last - first + 1 > columns) then
            last = first - 1 + index(text(first:first + columns - before), ' ', back=.true.) - 1
            if (last < first) last = len(text)
         end if
         lines = lines//text(first:last)
         if (last == len(text)) exit
         lines = lines//nl//repeat(' ', indent)
         before = indent
         first = last + 2
      end do
   end function folded

   !> `text` with blanks behind it up to `length` characters, and with one at least; '' stays empty.
   pure function padded(text, length) result(longer)
      character(*), intent(in) :: text
      integer, intent(in) :: length
      character(:), allocatable :: longer

      longer = text
      if (len(text) > 0) longer = text//repeat(' ', max(1, length - len(text)))
   end function padded

   !> `text` without the marks ` of alternatives.
   pure function without_marks(text) result(plain)
      character(*), intent(in) :: text
      character(:), allocatable :: plain
      integer :: i

      plain = ''
      do i = 1, len(text)
         if (text(i:i) /= '`') plain = plain//text(i:i)
      end do
   end function without_marks

   !> `text` with single blanks between its words and none around.
   pure function single_blanks(text) result(short)
      character(*), intent(in) :: text
      character(:), allocatable :: short
      integer :: i

      short = ''
      do i = 1, len_trim(text)
         if (text(i:i) /= ' ') then
            short = short//text(i:i)
         else if (len(short) > 0) then
            if (short(len(short):) /= ' ') short = short//' '
         end if
      end do
   end function single_blanks
end module explanations
