!> malloc, calloc and realloc of the command and of all libraries that it calls: if memory is short, the process ends
!> with a message and exit status 3. Code that gfortran makes for an assignment uses memory without a check that
!> there is any.
!>
!> The dynamic linker finds these procedures before those of the C library. This file is linked with main and does not
!> belong to the library: another program that uses the modules keeps its own.
module allocation
   use, intrinsic :: iso_c_binding, only: c_size_t, c_ptr, c_associated
   use failures, only: status_system
   use processes, only: end_process
   use system_calls, only: write_bytes
   implicit none
   private

   interface
      !> Calls malloc(3) of the C library.
      type(c_ptr) function libc_malloc(length) bind(c, name='__libc_malloc')
         import :: c_ptr, c_size_t
         integer(c_size_t), value :: length  !< bytes
      end function libc_malloc
      !> Calls calloc(3) of the C library.
      type(c_ptr) function libc_calloc(count, length) bind(c, name='__libc_calloc')
         import :: c_ptr, c_size_t
         integer(c_size_t), value :: count   !< elements
         integer(c_size_t), value :: length  !< bytes of an element
      end function libc_calloc
      !> Calls realloc(3) of the C library.
      type(c_ptr) function libc_realloc(place, length) bind(c, name='__libc_realloc')
         import :: c_ptr, c_size_t
         type(c_ptr), value :: place         !< memory that was allocated before, or null
         integer(c_size_t), value :: length  !< bytes
      end function libc_realloc
   end interface

contains

   !> Allocates memory: malloc(3). Ends the process if there is none.
   type(c_ptr) function malloc(length) bind(c) result(place)
      integer(c_size_t), value :: length  !< bytes

      place = libc_malloc(length)
      if (.not. c_associated(place)) call end_without_memory
   end function malloc

   !> Allocates memory for elements, all bytes 0: calloc(3). Ends the process if there is none.
   type(c_ptr) function calloc(count, length) bind(c) result(place)
      integer(c_size_t), value :: count   !< elements
      integer(c_size_t), value :: length  !< bytes of an element

      place = libc_calloc(count, length)
      if (.not. c_associated(place)) call end_without_memory
   end function calloc

   !> Changes the size of allocated memory: realloc(3). Ends the process if there is none.
   type(c_ptr) function realloc(before, length) bind(c) result(place)
      type(c_ptr), value :: before        !< memory that was allocated before, or null
      integer(c_size_t), value :: length  !< bytes; 0 frees the memory

      place = libc_realloc(before, length)
      if (.not. c_associated(place) .and. length /= 0) call end_without_memory
   end function realloc

   !> Ends the process with a message that needs no memory.
   subroutine end_without_memory
      integer(c_size_t) :: ignored

      ignored = write_bytes(2, ' *** NOT ENOUGH MEMORY FOR THE DECK'//new_line('a'))
      call end_process(status_system)
   end subroutine end_without_memory
end module allocation
