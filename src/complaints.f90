!> Level 3. The errors of a deck: each with a picture of its card and a mark under the column.
module complaints
   use cards, only: card_t, field_t, card_columns, field_text, first_column
   use deck_codes, only: code_t
   implicit none
   private
   public :: complaints_t, complain, complain_field, complain_deck, show_layout
   public :: complaint_count, complaints_full, complaints_report, whole_text

   !> As many are told in full; of the rest only the number.
   integer, parameter :: told_at_most = 50

   type :: complaints_t
      private
      integer :: count = 0
      character(:), allocatable :: lines
   end type complaints_t

contains

   !> Adds the complaint: what `code` says about `text` (may be empty) at `column` of `field` of `card`.
   !> `more` completes the sentence.
   subroutine complain(list, code, card, field, column, text, more)
      type(complaints_t), intent(inout) :: list
      type(code_t), intent(in) :: code
      type(card_t), intent(in) :: card
      type(field_t), intent(in) :: field
      integer, intent(in) :: column
      character(*), intent(in) :: text, more
      character(:), allocatable :: quoted

      list%count = list%count + 1
      if (list%count > told_at_most) return
      quoted = ''
      if (text /= '') quoted = ' "'//printable(trim(text))//'"'
      call add_picture(list, card, column)
      call add_line(list, message_head(code)//'  CARD '//whole_text(card%number)//'  COLUMN '// &
                    whole_text(column)//'  FIELD '//trim(field%name)//':'//quoted//sentence(code, more))
   end subroutine complain

   !> The same about everything that stands in `field`.
   subroutine complain_field(list, code, card, field, more)
      type(complaints_t), intent(inout) :: list
      type(code_t), intent(in) :: code
      type(card_t), intent(in) :: card
      type(field_t), intent(in) :: field
      character(*), intent(in) :: more

      call complain(list, code, card, field, first_column(card, field), field_text(card, field), more)
   end subroutine complain_field

   !> A complaint about the deck, not about a card.
   subroutine complain_deck(list, code, more)
      type(complaints_t), intent(inout) :: list
      type(code_t), intent(in) :: code
      character(*), intent(in) :: more

      list%count = list%count + 1
      if (list%count <= told_at_most) call add_line(list, message_head(code)//' '//sentence(code, more))
   end subroutine complain_deck

   !> Below a complaint in full: what the fields of such a card hold, under its picture.
   subroutine show_layout(list, layout)
      type(complaints_t), intent(inout) :: list
      character(*), intent(in) :: layout

      if (list%count <= told_at_most) call add_line(list, ' LAYOUT    |'//trim(layout))
   end subroutine show_layout

   pure integer function complaint_count(list)
      type(complaints_t), intent(in) :: list

      complaint_count = list%count
   end function complaint_count

   !> Further complaints are only counted: their words need no work.
   pure logical function complaints_full(list)
      type(complaints_t), intent(in) :: list

      complaints_full = list%count >= told_at_most
   end function complaints_full

   !> All lines, joined by new_line('a'); empty if there is no complaint.
   pure function complaints_report(list) result(report)
      type(complaints_t), intent(in) :: list
      character(:), allocatable :: report

      report = ''
      if (allocated(list%lines)) report = list%lines
      if (list%count > told_at_most) report = report//new_line('a')//' *** AND '// &
                                              whole_text(list%count - told_at_most)//' MORE'
   end function complaints_report

   !> A whole number in as many characters as it needs.
   pure function whole_text(n) result(text)
      integer, intent(in) :: n
      character(:), allocatable :: text
      character(12) :: buffer

      write (buffer, '(i0)') n
      text = trim(buffer)
   end function whole_text

   !> The card, a ruler in tens as far as the card or the mark reaches, and the mark.
   subroutine add_picture(list, card, column)
      type(complaints_t), intent(inout) :: list
      type(card_t), intent(in) :: card
      integer, intent(in) :: column
      character(:), allocatable :: head, shown, number, margin
      integer :: tens

      number = whole_text(card%number)
      head = ' CARD '//repeat(' ', max(4 - len(number), 0))//number//' |'
      shown = trim(card%text)
      ! What stands past the last column is shown if a page can hold it.
      if (card%overrun > 0 .and. card%overrun <= card_columns + 10) then
         shown = card%text//repeat(' ', card%overrun - card_columns - 1)//trim(card%beyond)
      end if
      call add_line(list, head//printable(shown))
      margin = repeat(' ', len(head) - 1)//'|'
      tens = min(max(len(shown)/10, (column + 9)/10), card_columns/10 + 1)
      call add_line(list, margin//ruler(tens))
      if (column <= 10*tens) call add_line(list, margin//repeat(' ', column - 1)//'^')
   end subroutine add_picture

   !> ....+....1....+....2 and so on, for so many tens of columns.
   pure function ruler(tens) result(text)
      integer, intent(in) :: tens
      character(10*tens) :: text
      integer :: i

      do i = 1, tens
         text(10*i - 9:10*i) = '....+....'//achar(iachar('0') + modulo(i, 10))
      end do
   end function ruler

   !> A byte that is not printable ASCII is shown as ?, so that columns stay columns.
   pure function printable(text) result(shown)
      character(*), intent(in) :: text
      character(len(text)) :: shown
      integer :: i

      shown = text
      do i = 1, len(text)
         if (ichar(text(i:i)) < 32 .or. ichar(text(i:i)) > 126) shown(i:i) = '?'
      end do
   end function printable

   pure function message_head(code) result(text)
      type(code_t), intent(in) :: code
      character(9) :: text

      write (text, '(a, i3.3)') ' *** E', code%number
   end function message_head

   pure function sentence(code, more) result(text)
      type(code_t), intent(in) :: code
      character(*), intent(in) :: more
      character(:), allocatable :: text

      text = ' '//trim(code%sentence)
      if (more /= '') text = text//' '//more
   end function sentence

   subroutine add_line(list, line)
      type(complaints_t), intent(inout) :: list
      character(*), intent(in) :: line

      if (allocated(list%lines)) then
         list%lines = list%lines//new_line('a')//line
      else
         list%lines = line
      end if
   end subroutine add_line
end module complaints
