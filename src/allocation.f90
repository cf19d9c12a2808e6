!> malloc, calloc and realloc of the command, and of the libraries that it calls: where memory lacks, the process ends
!> with a sentence and exit status 3. The code that gfortran makes for an assignment uses memory without a look whether
!> there is any.
!>
!> The dynamic linker finds these procedures before those of the system. This file is linked beside main and is not part
!> of the library: another program that uses the modules keeps its own.
module allocation
   use, intrinsic :: iso_c_binding, only: c_size_t, c_intptr_t, c_char, c_null_char, c_ptr, c_funptr, c_associated, &
      c_f_procpointer
   use processes, only: end_without_memory
   implicit none
   private

   !> The handle RTLD_NEXT of dlsym: a procedure of the libraries after this program.
   integer(c_intptr_t), parameter :: after_this = -1

   abstract interface
      !> malloc(3).
      type(c_ptr) function malloc_i(length) bind(c)
         import :: c_ptr, c_size_t
         integer(c_size_t), value :: length
      end function malloc_i
      !> calloc(3).
      type(c_ptr) function calloc_i(count, length) bind(c)
         import :: c_ptr, c_size_t
         integer(c_size_t), value :: count, length
      end function calloc_i
      !> realloc(3).
      type(c_ptr) function realloc_i(place, length) bind(c)
         import :: c_ptr, c_size_t
         type(c_ptr), value :: place
         integer(c_size_t), value :: length
      end function realloc_i
   end interface

   interface
      !> dlsym(3): the address of the procedure `name`.
      type(c_funptr) function dlsym(handle, name) bind(c)
         import :: c_intptr_t, c_char, c_funptr
         integer(c_intptr_t), value :: handle
         character(kind=c_char), intent(in) :: name(*)
      end function dlsym
   end interface

   !> Those of the system, or of a tool that stands in for it, such as a checker of memory.
   procedure(malloc_i), pointer :: system_malloc => null()
   procedure(calloc_i), pointer :: system_calloc => null()
   procedure(realloc_i), pointer :: system_realloc => null()

contains

   !> Allocates `length` bytes. Without memory the process ends.
   recursive type(c_ptr) function checked_malloc(length) bind(c, name='malloc') result(place)
      integer(c_size_t), value :: length

      if (.not. associated(system_malloc)) &
         call c_f_procpointer(dlsym(after_this, 'malloc'//c_null_char), system_malloc)
      place = system_malloc(length)
      if (.not. c_associated(place) .and. length > 0) call end_without_memory
   end function checked_malloc

   !> Allocates `count` elements of `length` bytes that are 0. Without memory the process ends.
   recursive type(c_ptr) function checked_calloc(count, length) bind(c, name='calloc') result(place)
      integer(c_size_t), value :: count, length

      if (.not. associated(system_calloc)) &
         call c_f_procpointer(dlsym(after_this, 'calloc'//c_null_char), system_calloc)
      place = system_calloc(count, length)
      if (.not. c_associated(place) .and. count > 0 .and. length > 0) call end_without_memory
   end function checked_calloc

   !> Changes the bytes at `before` to `length` bytes; 0 frees them. Without memory the process ends.
   recursive type(c_ptr) function checked_realloc(before, length) bind(c, name='realloc') result(place)
      type(c_ptr), value :: before
      integer(c_size_t), value :: length

      if (.not. associated(system_realloc)) &
         call c_f_procpointer(dlsym(after_this, 'realloc'//c_null_char), system_realloc)
      place = system_realloc(before, length)
      if (.not. c_associated(place) .and. length > 0) call end_without_memory
   end function checked_realloc
end module allocation
