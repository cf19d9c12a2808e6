!> The directions and slides of a block in isotropic coordinates, one group: w = exp(i phi) of each direction, z = s w
!> of each slide; the other group has their conjugates. Vector loops are linear forms of a group.
module isotropic
   use kinds, only: wp
   use planar, only: length_of
   use blocks, only: blocks_t, loop_angles
   use block_state, only: state_t
   implicit none
   private
   public :: equal_unknowns_t, make_group, given, find_direction, linear_form, size_of_loop, i_unit

   !> Unknown k of the block is unknown base(k) + offset(k); base 0 is none: the unknown is known.
   type :: equal_unknowns_t
      integer :: n = 0, q = 0                         !< unknowns of the block; directions and slides of one group
      integer, allocatable :: base(:)                 !< (n)
      real(wp), allocatable :: offset(:)              !< (n) in rad, or the unit of the slide
      integer, allocatable :: place(:)                !< (0:n) number of the direction or slide of a base in its group
      integer, allocatable :: turns(:)                !< (q) of a slide its direction, 0: a known one; of a direction -1
   end type equal_unknowns_t

   complex(wp), parameter :: i_unit = (0.0_wp, 1.0_wp)

contains

   !> The group of block `i`, for the values that `s` has of earlier blocks and drives.
   subroutine make_group(b, i, s, f)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(in) :: s
      type(equal_unknowns_t), intent(out) :: f

      call merge_angles(b, i, s, f)
      call number_places(b, i, f)
   end subroutine make_group

   !> Angles and slides that differ by what is given, as drives RELANGLE ask, are one unknown.
   subroutine merge_angles(b, i, s, f)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(in) :: s
      type(equal_unknowns_t), intent(inout) :: f
      integer :: m, k, first, second
      real(wp) :: apart, first_offset, second_offset

      f%n = b%list(i)%shape%n
      allocate (f%base(f%n), source=[(k, k=1, f%n)])
      allocate (f%offset(f%n), source=0.0_wp)
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            if (g%kind /= loop_angles) cycle
            call resolve(g%orientation_column, g%orientation, first, first_offset)
            call resolve(g%less_column, g%less, second, second_offset)
            apart = given(b, i, g%row_x, s) - first_offset + second_offset
         end associate
         ! first = second + apart: the later one gives way.
         if (first == second) cycle
         if (first > second) call replace(first, second, apart)
         if (second > first) call replace(second, first, -apart)
      end do

   contains

      !> The base and offset of unknown number `u` of all, in column `column` of the block.
      subroutine resolve(column, u, base, offset)
         integer, intent(in) :: column, u
         integer, intent(out) :: base
         real(wp), intent(out) :: offset

         base = 0
         offset = s%u(u)%value
         if (column == 0) return
         base = f%base(column)
         offset = f%offset(column)
      end subroutine resolve

      !> What stood on base `old` stands on `new`, which is less by `more`.
      subroutine replace(old, new, more)
         integer, intent(in) :: old, new
         real(wp), intent(in) :: more

         where (f%base == old)
            f%offset = f%offset + more
            f%base = new
         end where
      end subroutine replace
   end subroutine merge_angles

   !> What row `row` of block `i` asks for: its constant and its drive's value.
   pure real(wp) function given(b, i, row, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, row
      type(state_t), intent(in) :: s

      associate (k => b%list(i)%first_row + row - 1)
         given = b%numbers%rows(k)%constant + s%drive_value(0, b%rows(k)%drive)
      end associate
   end function given

   !> Numbers the directions and slides of a group, and finds the direction of each slide.
   subroutine number_places(b, i, f)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(equal_unknowns_t), intent(inout) :: f
      integer :: k, m

      allocate (f%place(0:f%n), f%turns(f%n), source=0)
      do k = 1, f%n
         if (f%base(k) /= k) cycle
         f%q = f%q + 1
         f%place(k) = f%q
      end do
      f%turns = -1
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         do k = b%loops(m)%first_slide, b%loops(m)%last_slide
            associate (slide => b%slides(k))
               if (slide%column == 0) cycle
               if (f%base(slide%column) == 0) cycle
               f%turns(f%place(slide%column)) = 0
               if (slide%orientation_column > 0) f%turns(f%place(slide%column)) = f%place(f%base( &
                  slide%orientation_column))
            end associate
         end do
      end do
   end subroutine number_places

   !> The direction of unknown number `u` of all, in column `column` of the block: `factor` times direction `at` of the
   !> group; 0: known.
   subroutine find_direction(f, column, u, s, at, factor)
      type(equal_unknowns_t), intent(in) :: f
      integer, intent(in) :: column, u
      type(state_t), intent(in) :: s
      integer, intent(out) :: at
      complex(wp), intent(out) :: factor

      at = 0
      factor = cmplx(s%u(u)%c, s%u(u)%s, wp)
      if (column == 0) return
      factor = exp(i_unit*f%offset(column))
      if (f%base(column) > 0) at = f%place(f%base(column))
   end subroutine find_direction

   !> (0:q) Loop `m`, as a linear form of the group.
   function linear_form(b, m, s, f) result(l)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m
      type(state_t), intent(in) :: s
      type(equal_unknowns_t), intent(in) :: f
      complex(wp) :: l(0:f%q), factor
      integer :: k, at
      real(wp) :: value

      l = 0.0_wp
      l(0) = cmplx(s%loop(m)%known(0)%x, s%loop(m)%known(0)%y, wp)
      do k = b%loops(m)%first_own, b%loops(m)%last_vector
         associate (d => b%body_vectors(k))
            call find_direction(f, d%column, d%orientation, s, at, factor)
            l(at) = l(at) + factor*cmplx(b%numbers%d(k)%x, b%numbers%d(k)%y, wp)
         end associate
      end do
      do k = b%loops(m)%first_slide, b%loops(m)%last_slide
         associate (e => b%slides(k))
            call find_direction(f, e%orientation_column, e%orientation, s, at, factor)
            factor = factor*cmplx(b%numbers%e(k)%x, b%numbers%e(k)%y, wp)
            value = s%u(e%unknown)%value
            if (e%column > 0) then
               value = f%offset(e%column)
               if (f%base(e%column) > 0) then
                  at = f%place(f%base(e%column))
                  value = 1.0_wp
               end if
            end if
            l(at) = l(at) + factor*value
         end associate
      end do
   end function linear_form

   !> The sum of the sizes of the terms of loop `m` that are known or of known length, in its unit: what rounding of the
   !> loop is measured by.
   pure real(wp) function size_of_loop(b, m, s) result(size_of)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m
      type(state_t), intent(in) :: s
      integer :: k

      associate (g => b%loops(m))
         size_of = length_of(b%numbers%loops(m)%ground)
         do k = g%first_vector, g%last_vector
            size_of = size_of + hypot(b%numbers%d(k)%x, b%numbers%d(k)%y)
         end do
         do k = g%first_slide, g%last_slide
            associate (e => b%slides(k))
               size_of = size_of + length_of(b%numbers%e(k))*merge(1.0_wp, abs(s%u(e%unknown)%value), e%column > 0)
            end associate
         end do
      end associate
   end function size_of_loop
end module isotropic
