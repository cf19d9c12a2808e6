!> Level 7. The cards of a set as they were understood, with the values in use, for the listing.
module deck_echo
   use mechanism, only: mechanism_t
   use cards, only: real_fields, wide_fields, field_text
   use card_forms, only: forms, form_title, form_units, form_at, form_method, form_print, form_star
   use card_reader, only: reals_taken
   use drafts, only: draft_t, cards_of
   use kinds, only: label_length
   implicit none
   private
   public :: build_echo

   integer, parameter :: line_length = 119, real_width = 25
   !> Column of the first label, of the first real, and the columns from one label to the next.
   integer, parameter :: label_column = 10, real_column = 37, label_step = 9
   character(*), parameter :: default_mark = '(DEFAULT)'

contains

   !> Makes `set`%echo: a line for every card except TITLE, and one for every default that no card replaces.
   subroutine build_echo(draft, set)
      type(draft_t), intent(in) :: draft
      type(mechanism_t), intent(inout) :: set
      integer :: k, n

      allocate (set%echo(draft%count + 3))
      n = 0
      do k = 1, draft%count
         if (draft%cards(k)%form == form_title .or. draft%cards(k)%form == form_star) cycle
         n = n + 1
         set%echo(n) = card_line(draft, k, set)
      end do
      call add_default(form_units, 'UNITS', &
                       [character(label_length) :: set%length_unit, 'RAD', set%time_unit])
      call add_default(form_method, 'METHOD', [character(label_length) :: 'NEWTON', '', ''])
      call add_default(form_print, 'PRINT', [character(label_length) :: 'LINKS', '', '1'])
      set%echo = set%echo(1:n)

   contains

      subroutine add_default(form, name, labels)
         integer, intent(in) :: form
         character(*), intent(in) :: name
         character(label_length), intent(in) :: labels(3)

         if (cards_of(draft, form) > 0) return
         n = n + 1
         set%echo(n) = head_line(name, labels)
         set%echo(n)(line_length - len(default_mark) + 1:) = default_mark
      end subroutine add_default
   end subroutine build_echo

   !> A blank real is shown as the 0.0 it stands for; a blank field of AT stands for nothing.
   pure function card_line(draft, k, set) result(line)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k
      type(mechanism_t), intent(in) :: set
      character(line_length) :: line
      character(label_length) :: labels(3)
      character(real_width) :: text
      integer :: i, column

      associate (card => draft%cards(k))
         labels = card%label
         if (card%form == form_print .and. labels(3) == '') labels(3) = '1'
         if (card%form == form_units) then
            labels(1) = set%length_unit
            labels(2) = merge('DEG', 'RAD', set%degrees)
            labels(3) = set%time_unit
         end if
         line = head_line(forms(card%form)%name, labels)
         do i = 1, reals_taken(card)
            if (card%starred(i)) then
               text = field_text(draft%cards(k + 1)%card, wide_fields(i))
            else if (card%given(i)) then
               text = field_text(card%card, real_fields(i))
            else
               text = merge('   ', '0.0', card%form == form_at)
            end if
            column = real_column + (i - 1)*real_width
            line(column:column + real_width - 1) = text
         end do
      end associate
   end function card_line

   pure function head_line(name, labels) result(line)
      character(*), intent(in) :: name
      character(label_length), intent(in) :: labels(3)
      character(line_length) :: line
      integer :: i, column

      line = name
      do i = 1, 3
         column = label_column + (i - 1)*label_step
         line(column:column + label_length - 1) = labels(i)
      end do
   end function head_line
end module deck_echo
