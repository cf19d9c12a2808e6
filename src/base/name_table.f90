!> A hash table from names to numbers (open addressing: Knuth, The Art of Computer Programming, vol. 3, sec. 6.4).
module name_table
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: label_length
   implicit none
   private
   public :: name_table_t, store_name, find_name

   !> Slots of a new table. Of the slots of any table at most every second one is filled.
   integer, parameter :: first_size = 64

   !> A slot of the table.
   type :: slot_t
      character(label_length) :: name = ''
      integer :: number = 0                !< 0: the slot is free
   end type slot_t

   !> A table of names, empty at first.
   type :: name_table_t
      private
      integer :: filled = 0                !< slots that are not free
      type(slot_t), allocatable :: slots(:)
   end type name_table_t

contains

   !> Enters a name with its number into a table. If the table has the name already, nothing changes.
   subroutine store_name(table, name, number, earlier)
      type(name_table_t), intent(inout) :: table   !< the names so far
      character(*), intent(in) :: name       !< at most `label_length` characters count
      integer, intent(in) :: number          !< of the name, above 0
      integer, intent(out) :: earlier        !< the number that the name has in the table already; 0: the name is new
      type(slot_t), allocatable :: old(:)
      integer :: slot, i

      if (.not. allocated(table%slots)) allocate (table%slots(first_size))
      slot = slot_of(table%slots, name)
      earlier = table%slots(slot)%number
      if (earlier /= 0) return
      table%slots(slot) = slot_t(name, number)
      table%filled = table%filled + 1
      if (2*table%filled <= size(table%slots)) return

      ! More than half of the slots are filled: their number is doubled.
      call move_alloc(table%slots, old)
      allocate (table%slots(2*size(old)))
      do i = 1, size(old)
         if (old(i)%number /= 0) table%slots(slot_of(table%slots, old(i)%name)) = old(i)
      end do
   end subroutine store_name

   !> Gives the number of a name, or 0 if the table does not have the name.
   pure integer function find_name(table, name) result(number)
      type(name_table_t), intent(in) :: table   !< the names so far
      character(*), intent(in) :: name   !< at most `label_length` characters count

      number = 0
      if (allocated(table%slots)) number = table%slots(slot_of(table%slots, name))%number
   end function find_name

   !> Finds the slot of a name: the slot that has the name or, if none has it, the free slot in which the name belongs.
   pure integer function slot_of(slots, name) result(k)
      type(slot_t), intent(in) :: slots(:)   !< (power of two) of a table; one slot at least is free
      character(*), intent(in) :: name   !< at most `label_length` characters count
      character(label_length) :: key
      !> A prime near 2**31, and the factor of a common polynomial hash: sums of eight characters fit in 64 bits.
      integer(int64), parameter :: prime = 2147483647_int64, factor = 131_int64
      integer(int64) :: hash
      integer :: i

      key = name
      ! A number below 2**31 - 1 that depends on every character; sums stay below 2**58.
      hash = 0_int64
      do i = 1, label_length
         hash = hash*factor + iachar(key(i:i))
      end do
      hash = modulo(hash, prime)
      k = 1 + int(modulo(hash, int(size(slots), int64)))
      do while (slots(k)%number /= 0)
         if (slots(k)%name == key) exit
         k = 1 + modulo(k, size(slots))
      end do
   end function slot_of
end module name_table
