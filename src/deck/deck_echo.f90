!> The echo of a set: its cards as they were understood, with the values in use.
module deck_echo
   use kinds, only: label_length
   use mechanism, only: method_words, method_newton
   use card_reader, only: parsed_card_t
   use card_sets, only: card_set_t, text_of
   use cards, only: label_a, real_1, form_name, reals_of, form_title, form_units, form_at, form_method, form_print, &
      form_pole, form_curve, form_vary
   implicit none
   private
   public :: build_echo

   !> The echo: its characters in a line, and in a real.
   integer, parameter :: line_length = 119, real_width = 25
   !> Column of the first label, column of the first real, and columns from one label to the next.
   integer, parameter :: label_column = 10, real_column = 37, label_step = 9
   character(*), parameter :: default_mark = '(DEFAULT)'

contains

   !> Builds `set`%mechanism%echo, the cards as they were understood with the values in use: a line for each card but
   !> TITLE, and one for each default that no card replaces.
   subroutine build_echo(set)
      type(card_set_t), intent(inout) :: set
      integer :: k, n, i

      associate (m => set%mechanism)
         allocate (m%echo(set%count + set%number_of(form_vary) + 3))
         n = 0
         do k = 1, set%count
            if (set%cards(k)%form /= form_title) call add_line(set%cards(k))
            if (.not. allocated(set%vary)) cycle
            do i = 1, size(set%vary)
               if (set%vary(i)%below == k) call add_line(set%vary(i)%card)
            end do
         end do
         call add_default(form_units, [m%length_unit, 'RAD     ', m%time_unit])
         call add_default(form_method, [character(label_length) :: method_words(method_newton), '', ''])
         if (m%variants == 0) call add_default(form_print, [character(label_length) :: 'LINKS', '', '1'])
         m%echo = m%echo(1:n)
      end associate

   contains

      !> Adds the line of `card`.
      subroutine add_line(card)
         type(parsed_card_t), intent(in) :: card

         n = n + 1
         set%mechanism%echo(n) = card_line(card, set%mechanism%length_unit, set%mechanism%time_unit)
      end subroutine add_line

      !> Adds the line of a form that has no card in the set: its defaults.
      subroutine add_default(form, labels)
         integer, intent(in) :: form
         character(label_length), intent(in) :: labels(3)

         if (set%number_of(form) > 0) return
         n = n + 1
         set%mechanism%echo(n) = head_line(form, labels)
         set%mechanism%echo(n)(line_length - len(default_mark) + 1:) = default_mark
      end subroutine add_default
   end subroutine build_echo

   !> The line of one card. A blank real is shown as 0.0, its value; a blank field of AT has none.
   pure function card_line(card, length_unit, time_unit) result(line)
      type(parsed_card_t), intent(in) :: card
      character(label_length), intent(in) :: length_unit, time_unit
      character(line_length) :: line
      character(label_length) :: labels(3)
      character(real_width) :: text
      integer :: i, column

      labels = card%label
      if (any(card%form == [form_print, form_pole, form_curve]) .and. labels(3) == '') labels(3) = '1'
      if (card%form == form_units) then
         labels(1) = length_unit
         if (labels(2) == '') labels(2) = 'RAD'
         labels(3) = time_unit
      end if
      line = head_line(card%form, labels)
      do i = 1, reals_of(card%form, card%label(label_a))
         text = merge('   ', '0.0', any(card%form == [form_at, form_vary]))
         if (card%given(i)) text = text_of(card, real_1 + i - 1)
         column = real_column + (i - 1)*real_width
         line(column:column + real_width - 1) = text
      end do
   end function card_line

   !> The name and the labels of a card, in the columns of the echo.
   pure function head_line(form, labels) result(line)
      integer, intent(in) :: form
      character(label_length), intent(in) :: labels(3)
      character(line_length) :: line
      integer :: i, column

      line = form_name(form)
      do i = 1, 3
         column = label_column + (i - 1)*label_step
         line(column:column + label_length - 1) = labels(i)
      end do
   end function head_line
end module deck_echo
