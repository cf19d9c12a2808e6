!> Tests. A deck as lines that can be changed field by field, with the dice for it; and the sets of the decks of input/.
module deck_text
   use kinds, only: wp
   use dice, only: dice_t, throw, chance, between, magnitude
   implicit none
   private
   public :: deck_text_t, line_length, read_sets, name_of, label, set_label, real_field, set_real, set_full
   public :: put_real, set_off, near, insert_line, drop_line, line_behind, copy_card, find_cards, any_card, is_degrees
   public :: add_note, write_deck

   integer, parameter :: line_length = 200

   type :: deck_text_t
      type(dice_t) :: dice
      character(line_length), allocatable :: line(:)
      character(line_length), allocatable :: notes(:) !< what was done to it
   end type deck_text_t

contains

   !> Adds the sets of the deck in the file `path` to `sets`, without comments.
   subroutine read_sets(path, sets)
      character(*), intent(in) :: path
      type(deck_text_t), allocatable, intent(inout) :: sets(:)
      character(line_length) :: line
      type(deck_text_t) :: one
      integer :: unit, status

      allocate (one%line(0))
      open (newunit=unit, file=path, status='old', action='read')
      do
         read (unit, '(a)', iostat=status) line
         if (status /= 0) exit
         if (line(1:1) == '$') cycle
         one%line = [character(line_length) :: one%line, line]
         if (name_of(line) /= 'END') cycle
         one%notes = [character(line_length) :: path]
         sets = [sets, one]
         one%line = one%line(1:0)
      end do
      close (unit)
   end subroutine read_sets

   pure function name_of(line) result(name)
      character(*), intent(in) :: line
      character(8) :: name

      name = line(1:8)
   end function name_of

   !> Label field `k` (1 to 3).
   pure function label(line, k)
      character(*), intent(in) :: line
      integer, intent(in) :: k
      character(8) :: label

      label = line(8*k + 1:8*k + 8)
   end function label

   subroutine set_label(line, k, text)
      character(*), intent(inout) :: line
      integer, intent(in) :: k
      character(*), intent(in) :: text

      line(8*k + 1:8*k + 8) = text
   end subroutine set_label

   !> Real field `k` (1 to 3) of card `i`, from the `*` card below it if that has it; 0 where there is no number.
   real(wp) function real_field(d, i, k)
      type(deck_text_t), intent(in) :: d
      integer, intent(in) :: i, k
      integer :: status

      status = 1
      real_field = 0.0_wp
      if (has_star(d, i)) call take(d%line(i + 1)(24*k - 15:24*k + 8), real_field, status)
      if (status /= 0) call take(d%line(i)(16*k + 17:16*k + 32), real_field, status)
      if (status /= 0) real_field = 0.0_wp
      if (.not. abs(real_field) <= huge(real_field)) real_field = 0.0_wp
   end function real_field

   !> The number in `text`. An exponent without a digit before it ends gfortran's programs, `iostat` or not.
   subroutine take(text, x, status)
      character(*), intent(in) :: text
      real(wp), intent(out) :: x
      integer, intent(out) :: status
      integer :: exponent

      x = 0.0_wp
      status = 1
      exponent = scan(text, 'EeDdQq')
      if (exponent > 0) then
         if (scan(text(:exponent), '0123456789') == 0) return
      end if
      read (text, '(bn,f40.0)', iostat=status) x
   end subroutine take

   !> A `*` card is below card `i`.
   pure logical function has_star(d, i)
      type(deck_text_t), intent(in) :: d
      integer, intent(in) :: i

      has_star = i < size(d%line)
      if (has_star) has_star = d%line(i + 1)(1:1) == '*'
   end function has_star

   !> Real field `k` of card `i` becomes `x`, to the nine digits that its columns hold.
   subroutine set_real(d, i, k, x)
      type(deck_text_t), intent(inout) :: d
      integer, intent(in) :: i, k
      real(wp), intent(in) :: x
      character(16) :: text

      if (has_star(d, i)) then
         call set_full(d, i, k, x)
      else
         write (text, '(es16.8e3)') x
         d%line(i)(16*k + 17:16*k + 32) = adjustl(text)
      end if
   end subroutine set_real

   !> The same with all digits, on a `*` card.
   subroutine set_full(d, i, k, x)
      type(deck_text_t), intent(inout) :: d
      integer, intent(in) :: i, k
      real(wp), intent(in) :: x
      integer :: c
      real(wp) :: others(3)
      character(24) :: text

      others = [(real_field(d, i, c), c=1, 3)]
      others(k) = x
      if (.not. has_star(d, i)) call insert_line(d, i + 1, '*')
      d%line(i)(33:80) = ''
      do c = 1, 3
         if (.not. (abs(others(c)) > 0.0_wp .or. c == k)) cycle
         write (text, '(es24.16e3)') others(c)
         d%line(i + 1)(24*c - 15:24*c + 8) = adjustl(text)
      end do
   end subroutine set_full

   !> Writes `x` with nine digits or with all.
   subroutine put_real(d, i, k, x)
      type(deck_text_t), intent(inout) :: d
      integer, intent(in) :: i, k
      real(wp), intent(in) :: x

      if (chance(d%dice, 0.2_wp)) then
         call set_full(d, i, k, x)
      else
         call set_real(d, i, k, x)
      end if
   end subroutine put_real

   !> A changed number: times a factor, a little off, rounded to a whole, of the other sign.
   real(wp) function near(d, x)
      type(deck_text_t), intent(inout) :: d
      real(wp), intent(in) :: x

      select case (throw(d%dice, 8))
      case (1:3); near = x*between(d%dice, 0.6_wp, 1.6_wp)
      case (4); near = x*(1.0_wp + between(d%dice, -1.0_wp, 1.0_wp)*10.0_wp**(-throw(d%dice, 14)))
      case (5); near = x + between(d%dice, -1.0_wp, 1.0_wp)*max(abs(x), 1.0_wp)
      case (6); near = anint(x)
      case (7); near = -x
      case default; near = x*magnitude(d%dice, 2)
      end select
   end function near

   !> Real field `k` of card `i` is off by chance, by 1E-15 to 1.
   subroutine set_off(d, i, k)
      type(deck_text_t), intent(inout) :: d
      integer, intent(in) :: i, k

      call set_full(d, i, k, real_field(d, i, k) + between(d%dice, -1.0_wp, 1.0_wp)*10.0_wp**(-between(d%dice, 0.0_wp, &
         15.0_wp)))
   end subroutine set_off

   !> `line` becomes line number `i`.
   subroutine insert_line(d, i, line)
      type(deck_text_t), intent(inout) :: d
      integer, intent(in) :: i
      character(*), intent(in) :: line
      character(line_length) :: one

      one = line
      d%line = [character(line_length) :: d%line(:i - 1), one, d%line(i:)]
   end subroutine insert_line

   subroutine drop_line(d, i)
      type(deck_text_t), intent(inout) :: d
      integer, intent(in) :: i

      d%line = [character(line_length) :: d%line(:i - 1), d%line(i + 1:)]
   end subroutine drop_line

   !> The line behind card `i` and its `*` card.
   pure integer function line_behind(d, i)
      type(deck_text_t), intent(in) :: d
      integer, intent(in) :: i

      line_behind = i + merge(2, 1, has_star(d, i))
   end function line_behind

   !> A second card like card `i`, with its `*` card and, for a drive, its terms, from line `at` on.
   subroutine copy_card(d, i, at)
      type(deck_text_t), intent(inout) :: d
      integer, intent(in) :: i
      integer, intent(out) :: at

      do at = i + 1, size(d%line)
         if (d%line(at)(1:1) /= '*' .and. all(name_of(d%line(at)) /= ['ADD ', 'RISE'])) exit
      end do
      d%line = [character(line_length) :: d%line(:at - 1), d%line(i:at - 1), d%line(at:)]
   end subroutine copy_card

   !> Numbers of the lines whose card has one of `names`.
   pure function find_cards(d, names) result(found)
      type(deck_text_t), intent(in) :: d
      character(8), intent(in) :: names(:)
      integer, allocatable :: found(:)
      logical :: is_one(size(d%line))
      integer :: i

      do i = 1, size(d%line)
         is_one(i) = any(names == name_of(d%line(i)))
      end do
      found = pack([(i, i=1, size(d%line))], is_one)
   end function find_cards

   !> The line of a card that has one of `names`, 0 if there is none.
   integer function any_card(d, names)
      type(deck_text_t), intent(inout) :: d
      character(8), intent(in) :: names(:)
      integer, allocatable :: cards(:)

      cards = find_cards(d, names)
      any_card = 0
      if (size(cards) > 0) any_card = cards(throw(d%dice, size(cards)))
   end function any_card

   logical function is_degrees(d)
      type(deck_text_t), intent(in) :: d
      integer, allocatable :: cards(:)

      cards = find_cards(d, ['UNITS   '])
      is_degrees = .false.
      if (size(cards) > 0) is_degrees = label(d%line(cards(1)), 2) == 'DEG'
   end function is_degrees

   subroutine add_note(d, text)
      type(deck_text_t), intent(inout) :: d
      character(*), intent(in) :: text

      d%notes = [character(line_length) :: d%notes, text]
   end subroutine add_note

   !> The lines of `d` to the file `path`, without blanks at their ends.
   subroutine write_deck(d, path)
      type(deck_text_t), intent(in) :: d
      character(*), intent(in) :: path
      integer :: unit, i

      open (newunit=unit, file=path, access='stream', form='unformatted', status='replace', action='write')
      do i = 1, size(d%line)
         write (unit) trim(d%line(i))//new_line('a')
      end do
      close (unit)
   end subroutine write_deck
end module deck_text
