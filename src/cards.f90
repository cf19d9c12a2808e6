!> Level 1. One card: 80 columns, and the fields by column. A field is declared here once and nowhere else.
module cards
   implicit none
   private
   public :: card_t, field_t, card_columns, no_field
   public :: name_field, label_fields, real_fields, wide_fields, title_field, card_fields
   public :: field_text, first_column, ruler_card, is_passed_over

   !> Columns of a card.
   integer, parameter :: card_columns = 80

   type :: card_t
      integer :: number = 0                 !< of the line in the deck, from 1
      integer :: overrun = 0                !< first column past 80 that is not blank; 0: none
      character(card_columns) :: text = ''
      character(24) :: beyond = ''          !< what stands from column `overrun` on, the beginning of it
   end type card_t

   type :: field_t
      character(8) :: name = ''
      integer :: first = 1, last = 0
   end type field_t

   type(field_t), parameter :: no_field = field_t('', 1, 0)
   type(field_t), parameter :: name_field = field_t('NAME', 1, 8)
   type(field_t), parameter :: title_field = field_t('TITLE', 9, 80)
   !> Labels or whole numbers.
   type(field_t), parameter :: label_fields(3) = &
      [field_t('LABEL-A', 9, 16), field_t('LABEL-B', 17, 24), field_t('LABEL-C', 25, 32)]
   type(field_t), parameter :: real_fields(3) = &
      [field_t('REAL-1', 33, 48), field_t('REAL-2', 49, 64), field_t('REAL-3', 65, 80)]
   !> The reals of a `*` card: wide enough for every double.
   type(field_t), parameter :: wide_fields(3) = &
      [field_t('REAL-1', 9, 32), field_t('REAL-2', 33, 56), field_t('REAL-3', 57, 80)]
   !> All fields of a card in the order of their columns; field i + 1 begins where field i ends.
   type(field_t), parameter :: card_fields(7) = [name_field, label_fields, real_fields]

contains

   !> A card's text in a field, without the blanks around it.
   pure function field_text(card, field) result(text)
      type(card_t), intent(in) :: card
      type(field_t), intent(in) :: field
      character(:), allocatable :: text

      text = trim(adjustl(card%text(field%first:field%last)))
   end function field_text

   !> The column of the first character of `field` that is not blank; its first column if all are.
   pure integer function first_column(card, field) result(column)
      type(card_t), intent(in) :: card
      type(field_t), intent(in) :: field

      column = field%first + max(verify(card%text(field%first:field%last), ' '), 1) - 1
   end function first_column

   !> A comment ($ in column 1) or a blank card.
   pure logical function is_passed_over(card)
      type(card_t), intent(in) :: card

      is_passed_over = card%text(1:1) == '$'
      if (.not. is_passed_over) is_passed_over = card%overrun == 0 .and. card%text == ''
   end function is_passed_over

   !> The comment card that shows the columns of every field.
   pure function ruler_card() result(text)
      character(card_columns) :: text
      type(field_t) :: f
      integer :: i

      text = repeat('-', card_columns)
      do i = 1, size(card_fields)
         f = card_fields(i)
         text(f%first:f%first + len_trim(f%name) - 1) = f%name
         if (i > 1) text(f%last:f%last) = '|'
      end do
      text(1:5) = '$'//name_field%name(1:4)
   end function ruler_card
end module cards
