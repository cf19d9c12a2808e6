!> Names: a hash table from names to numbers (open addressing), and names in messages.
module names
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: label_length
   use mechanism, only: mechanism_t, drive_t, drive_words, driven_kinds, drive_relangle, request_link, request_point
   use numerals, only: whole
   implicit none
   private
   public :: name_table_t, put_name, find_name, drive_name, subject_name, listed, more

   !> Slots of an empty table. At most every second slot is filled.
   integer, parameter :: first_size = 64

   !> A place of the table.
   type :: slot_t
      character(label_length) :: name = ''
      integer :: number = 0                !< 0: the slot is free
   end type slot_t

   type :: name_table_t
      private
      integer :: filled = 0                !< slots that are not free
      type(slot_t), allocatable :: slots(:)
   end type name_table_t

   !> The largest number of names in a list, and of its characters; the rest is only counted. Drives have long names.
   integer, parameter :: max_names = 8, max_listed = 84

contains

   !> Enters `name` with `number` > 0. If the table has it already, nothing changes and `earlier` is its number;
   !> otherwise `earlier` is 0.
   subroutine put_name(table, name, number, earlier)
      type(name_table_t), intent(inout) :: table
      character(*), intent(in) :: name
      integer, intent(in) :: number
      integer, intent(out) :: earlier
      integer :: slot

      if (.not. allocated(table%slots)) allocate (table%slots(first_size))
      slot = slot_of(table%slots, name)
      earlier = table%slots(slot)%number
      if (earlier /= 0) return
      table%slots(slot) = slot_t(name, number)
      table%filled = table%filled + 1
      if (2*table%filled > size(table%slots)) call double_slots(table%slots)
   end subroutine put_name

   !> The number of `name`, or 0 if the table does not have it.
   pure integer function find_name(table, name) result(number)
      type(name_table_t), intent(in) :: table
      character(*), intent(in) :: name

      number = 0
      if (allocated(table%slots)) number = table%slots(slot_of(table%slots, name))%number
   end function find_name

   !> The kind of drive `d` of the mechanism `m` and what it drives, as on its card.
   pure function drive_name(m, d) result(name)
      type(mechanism_t), intent(in) :: m
      type(drive_t), intent(in) :: d
      character(3*label_length + 2) :: name

      name = trim(drive_words(d%kind))//' '//subject_name(m, driven_kinds(d%kind), d%subject)
      if (d%kind == drive_relangle) name = trim(name)//' '//m%links(d%second)%name
   end function drive_name

   !> The name of the link, point or pair (`kind`, as of a request) with the number `subject`.
   pure function subject_name(m, kind, subject) result(name)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: kind, subject
      character(label_length) :: name

      select case (kind)
      case (request_link)
         name = m%links(subject)%name
      case (request_point)
         name = m%points(subject)%name
      case default
         name = m%pairs(subject)%name
      end select
   end function subject_name

   !> The names `words` (at least one) with commas between them; of many, the first ones and the number of the rest, in
   !> Polish or in English.
   pure function listed(words, polish) result(text)
      character(*), intent(in) :: words(:)
      logical, intent(in) :: polish
      character(:), allocatable :: text
      integer :: i

      text = trim(words(1))
      do i = 2, min(size(words), max_names)
         if (len(text) + 2 + len_trim(words(i)) > max_listed) exit
         text = text//', '//trim(words(i))
      end do
      text = text//more(size(words) - i + 1, polish)
   end function listed

   !> The end of a list of which `n` are left out: ' AND 3 MORE'; '' where none are.
   pure function more(n, polish) result(text)
      integer, intent(in) :: n
      logical, intent(in) :: polish
      character(:), allocatable :: text

      text = ''
      if (n == 0) return
      text = ' AND '//whole(n)//' MORE'
      if (polish) text = ' I '//whole(n)//' INNE'
   end function more

   !> The slot of `name`, or the free slot where it belongs. There is always a free slot.
   pure integer function slot_of(slots, name) result(k)
      type(slot_t), intent(in) :: slots(:)
      character(*), intent(in) :: name
      character(label_length) :: key

      key = name
      k = 1 + int(modulo(hash(key), int(size(slots), int64)))
      do while (slots(k)%number /= 0)
         if (slots(k)%name == key) exit
         k = 1 + modulo(k, size(slots))
      end do
   end function slot_of

   !> A number below 2**31 - 1 that depends on every character; sums stay below 2**58.
   pure integer(int64) function hash(key)
      character(label_length), intent(in) :: key
      integer(int64), parameter :: prime = 2147483647_int64, factor = 131_int64
      integer :: i

      hash = 0_int64
      do i = 1, label_length
         hash = hash*factor + iachar(key(i:i))
      end do
      hash = modulo(hash, prime)
   end function hash

   !> Doubles the number of slots; the names stay.
   subroutine double_slots(slots)
      type(slot_t), allocatable, intent(inout) :: slots(:)
      type(slot_t), allocatable :: old(:)
      integer :: i

      call move_alloc(slots, old)
      allocate (slots(2*size(old)))
      do i = 1, size(old)
         if (old(i)%number /= 0) slots(slot_of(slots, old(i)%name)) = old(i)
      end do
   end subroutine double_slots
end module names
