!> Level 2. A table of names: from a label to its number in constant time (open addressing).
module names
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: label_length
   implicit none
   private
   public :: name_table_t, put_name, find_name

   !> Slots of an empty table and the share of them that may be filled: one in two.
   integer, parameter :: first_size = 64

   type :: name_table_t
      private
      integer :: filled = 0
      character(label_length), allocatable :: keys(:)
      integer, allocatable :: numbers(:)   !< 0: the slot is free
   end type name_table_t

contains

   !> Enters `name` with `number` > 0. If it was there already, nothing changes and `earlier` is its
   !> number; otherwise `earlier` is 0.
   subroutine put_name(table, name, number, earlier)
      type(name_table_t), intent(inout) :: table
      character(*), intent(in) :: name
      integer, intent(in) :: number
      integer, intent(out) :: earlier
      integer :: slot

      if (.not. allocated(table%keys)) call make_slots(table, first_size)
      slot = slot_of(table, name)
      earlier = table%numbers(slot)
      if (earlier /= 0) return
      table%keys(slot) = name
      table%numbers(slot) = number
      table%filled = table%filled + 1
      if (2*table%filled > size(table%keys)) call double_slots(table)
   end subroutine put_name

   !> The number of `name`, or 0 if the table does not hold it.
   pure integer function find_name(table, name) result(number)
      type(name_table_t), intent(in) :: table
      character(*), intent(in) :: name

      number = 0
      if (allocated(table%keys)) number = table%numbers(slot_of(table, name))
   end function find_name

   !> The slot that holds `name`, or the free one where it belongs. A free slot always exists.
   pure integer function slot_of(table, name) result(slot)
      type(name_table_t), intent(in) :: table
      character(*), intent(in) :: name
      character(label_length) :: key

      key = name
      slot = 1 + int(modulo(hash(key), int(size(table%keys), int64)))
      do while (table%numbers(slot) /= 0)
         if (table%keys(slot) == key) exit
         slot = 1 + modulo(slot, size(table%keys))
      end do
   end function slot_of

   !> A number below 2**31 - 1 that depends on every character. The product stays below 2**56.
   pure integer(int64) function hash(key)
      character(label_length), intent(in) :: key
      integer(int64), parameter :: prime = 2147483647_int64, factor = 16777619_int64
      integer :: i

      hash = 0_int64
      do i = 1, label_length
         hash = modulo(hash*factor + iachar(key(i:i)), prime)
      end do
   end function hash

   subroutine double_slots(table)
      type(name_table_t), intent(inout) :: table
      type(name_table_t) :: larger
      integer :: i, slot

      call make_slots(larger, 2*size(table%keys))
      do i = 1, size(table%keys)
         if (table%numbers(i) == 0) cycle
         slot = slot_of(larger, table%keys(i))
         larger%keys(slot) = table%keys(i)
         larger%numbers(slot) = table%numbers(i)
      end do
      call move_alloc(larger%keys, table%keys)
      call move_alloc(larger%numbers, table%numbers)
   end subroutine double_slots

   subroutine make_slots(table, n)
      type(name_table_t), intent(inout) :: table
      integer, intent(in) :: n

      allocate (table%keys(n))
      allocate (table%numbers(n), source=0)
   end subroutine make_slots
end module names
