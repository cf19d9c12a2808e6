!> What the documents say of messages and of the fields of cards, as lines for a terminal: --explain, --ruler CARD.
module explanations
   use failures, only: capitals
   use document_texts, only: message_cell, message_count, explained_fields
   implicit none
   private
   public :: explained, explained_fields

   !> A printed message is known by its words, if these have more letters than LINKS and one name.
   integer, parameter :: known_length = 14

contains

   !> Gives the entries of docs/messages.md that `words` ask for, or '' if there are none: the entries of the code in
   !> `words`. Without a code, those whose message holds the words; otherwise those of the printed message `words`.
   pure function explained(words) result(text)
      character(*), intent(in) :: words
      character(:), allocatable :: text
      character(:), allocatable :: key, codes
      integer :: i, k
      integer :: scores(message_count)

      text = ''
      ! Single blanks between words.
      key = trim(adjustl(capitals(words)))
      do while (index(key, '  ') > 0)
         i = index(key, '  ')
         key = key(:i)//adjustl(key(i:))
         key = trim(key)
      end do
      if (len(key) == 0) return

      scores = 0
      do i = 1, message_count
         ! Codes are separated by a comma and a blank.
         codes = message_cell(i, 1)
         if (any([(index(' '//key//' ', ' '//codes(k:k + 3)//' ') > 0, k=1, len(codes) - 3, 6)])) scores(i) = 1
      end do
      if (all(scores == 0)) scores = [(merge(1, 0, index(message_cell(i, 3), key) > 0), i=1, message_count)]
      if (all(scores == 0)) scores = [(likeness(message_cell(i, 2), key), i=1, message_count)]
      if (all(scores == 0)) return
      do i = 1, message_count
         if (scores(i) < maxval(scores)) cycle
         if (len(text) > 0) text = text//new_line('a')//new_line('a')
         text = text//message_cell(i, 4)
      end do
   end function explained

   !> How many letters of a printed message are words of `message`, all of which it must have in their order; else 0.
   !> A mark ` stands between alternatives of `message`.
   pure integer function likeness(message, key) result(letters)
      character(*), intent(in) :: message, key
      character(:), allocatable :: text
      integer :: first, last, place, found, own

      letters = 0
      text = message//'`'
      first = 1
      place = 1
      own = 0
      do while (first <= len(text))
         last = first + scan(text(first:), ' `') - 2
         found = index(key(place:), text(first:last))
         ! An alternative of which a word is missing stays below 0.
         own = merge(own + last - first + 1, -len(text), found > 0)
         if (found > 0) place = place + found + last - first
         if (text(last + 1:last + 1) == '`') then
            letters = max(letters, own)
            place = 1
            own = 0
         end if
         first = last + 2
      end do
      if (letters < known_length) letters = 0
   end function likeness
end module explanations
