!> Tests. The deck as a listing repeats it, read for what its tables must hold: units, kinds of pairs, drives, and the rows
!> that the PRINT cards ask for.
module echoed_deck
   implicit none
   private
   public :: echoed_deck_t, due_t, new_echoed_deck, read_card, expand_requests, is_slide, label_length, word_length, &
      kind_of_row

   integer, parameter :: label_length = 8, word_length = 16
   integer, parameter :: label_first(0:3) = [2, 11, 20, 29]
   character(7), parameter :: kind_of_row(4) = [character(7) :: 'LINK', 'POINT', 'PAIR', 'MEASURE']

   !> The row of one link (1), point (2), pair (3) or measure (4), at every `every`-th instant; no name: all of them.
   type :: due_t
      integer :: kind = 0, every = 1
      character(label_length) :: name = ''
   end type due_t

   !> A drive by the words of its card; the `column` of the row of `kind` and `name` has the same value.
   type :: drive_words_t
      character(3*label_length + 2) :: words = ''
      integer :: kind = 0, column = 0            !< 0: no row has it
      character(label_length) :: name = ''
      logical :: is_angle = .false.
      character(word_length) :: value = ''       !< at the instant at hand, over 10**power
      integer :: power = 0
   end type drive_words_t

   type :: echoed_deck_t
      character(label_length) :: units(3) = ''   !< of length, angle and time
      type(due_t), allocatable :: named(:)       !< links that move, points and pairs, in the order of their cards
      logical, allocatable :: slides(:)          !< (named) prismatic pairs, and measures that are lengths
      type(due_t), allocatable :: requests(:)
      type(drive_words_t), allocatable :: drives(:)
      logical :: tolerances = .false.            !< below each row stand two more: what they make of it
   end type echoed_deck_t

contains

   function new_echoed_deck() result(d)
      type(echoed_deck_t) :: d

      allocate (d%named(0), d%slides(0), d%requests(0), d%drives(0))
   end function new_echoed_deck

   !> One card, as the listing prints it.
   subroutine read_card(d, line)
      type(echoed_deck_t), intent(inout) :: d
      character(*), intent(in) :: line
      character(label_length) :: label(0:3)
      integer :: i, every, status

      do i = 0, 3
         label(i) = line(label_first(i):label_first(i) + label_length - 1)
      end do
      select case (label(0))
      case ('UNITS'); d%units = label(1:3)
      case ('LINK'); call add_name(d, 1, label(1), .false.)
      case ('POINT'); call add_name(d, 2, label(1), .false.)
      case ('REVOLUTE', 'PRISM', 'SLOT', 'CYLINDER'); call add_name(d, 3, label(3), label(0) /= 'REVOLUTE')
      case ('JOINT')
         call add_name(d, 2, label(1), .false.)
         call add_name(d, 3, label(1), .false.)
      case ('DISTANCE', 'XI', 'ETA'); call add_name(d, 4, label(3), .true.)
      case ('LINE', 'ANGLE'); call add_name(d, 4, label(3), .false.)
      case ('SUM'); call add_name(d, 4, label(3), is_slide(d, 4, label(1)))
      case ('TOLER'); d%tolerances = .true.
      case ('DRIVE'); call add_drive(d, label(1:3))
      case ('PRINT')
         read (label(3), *, iostat=status) every
         if (status /= 0) every = 1
         do i = 1, 4
            if (label(1) == 'ALL' .or. label(1) == trim(kind_of_row(i))//'S') &
               d%requests = [d%requests, due_t(i, every, label(2))]
         end do
      end select
   end subroutine read_card

   subroutine add_drive(d, label)
      type(echoed_deck_t), intent(inout) :: d
      character(label_length), intent(in) :: label(3)
      type(drive_words_t) :: drive

      drive%words = trim(label(1))//' '//label(2)
      if (label(1) == 'RELANGLE') drive%words = trim(drive%words)//' '//label(3)
      drive%name = label(2)
      drive%is_angle = label(1) == 'ANGLE' .or. label(1) == 'RELANGLE'
      if (label(1) == 'ANGLE') drive%kind = 1
      if (label(1) == 'X' .or. label(1) == 'Y') drive%kind = 2
      if (label(1) == 'SLIDE') drive%kind = 3
      drive%column = index('XYA', label(1)(:1))
      if (label(1) == 'SLIDE') drive%column = 1
      d%drives = [d%drives, drive]
   end subroutine add_drive

   !> The pair of this `name` is prismatic, or the measure (`kind`) a length.
   pure logical function is_slide(d, kind, name)
      type(echoed_deck_t), intent(in) :: d
      integer, intent(in) :: kind
      character(*), intent(in) :: name

      is_slide = any(d%named%kind == kind .and. d%named%name == name .and. d%slides)
   end function is_slide

   subroutine add_name(d, kind, name, slides)
      type(echoed_deck_t), intent(inout) :: d
      integer, intent(in) :: kind
      character(*), intent(in) :: name
      logical, intent(in) :: slides

      d%named = [d%named, due_t(kind, 1, name)]
      d%slides = [d%slides, slides]
   end subroutine add_name

   !> To be called after the last card: in the place of requests for all there are those for each. The first one for a
   !> row counts.
   subroutine expand_requests(d)
      type(echoed_deck_t), intent(inout) :: d
      type(due_t), allocatable :: list(:)
      integer :: i, k

      allocate (list(0))
      do i = 1, size(d%requests)
         associate (r => d%requests(i))
            if (r%name /= '') call add_request(list, r)
            do k = 1, size(d%named)
               if (r%name == '' .and. d%named(k)%kind == r%kind) &
                  call add_request(list, due_t(r%kind, r%every, d%named(k)%name))
            end do
         end associate
      end do
      call move_alloc(list, d%requests)
   end subroutine expand_requests

   subroutine add_request(list, request)
      type(due_t), allocatable, intent(inout) :: list(:)
      type(due_t), intent(in) :: request

      if (any(list%kind == request%kind .and. list%name == request%name)) return
      list = [list, request]
   end subroutine add_request
end module echoed_deck
