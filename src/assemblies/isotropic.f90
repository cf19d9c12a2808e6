!> The directions and slides of a block in isotropic coordinates, one group: w = exp(i phi) of each direction, z = s w
!> of each slide; the other group has their conjugates. Vector loops are linear forms of a group.
module isotropic
   use kinds, only: wp
   use planar, only: length_of
   use blocks, only: blocks_t
   use block_state, only: state_t
   implicit none
   private
   public :: directions_of_slides, given, direction_factor, linear_form, size_of_loop, i_unit

   complex(wp), parameter :: i_unit = (0.0_wp, 1.0_wp)

contains

   !> (n) Of each unknown of block `i` that is a slide the number of its direction, 0: a known one; of a direction -1.
   pure function directions_of_slides(b, i) result(turns)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      integer :: turns(b%list(i)%shape%n)
      integer :: k

      turns = merge(-1, 0, b%unknown(b%list(i)%first:b%list(i)%last) <= b%orientations)
      do k = b%loops(b%list(i)%first_loop)%first_slide, b%loops(b%list(i)%last_loop)%last_slide
         if (b%slides(k)%column > 0) turns(b%slides(k)%column) = b%slides(k)%orientation_column
      end do
   end function directions_of_slides

   !> What row `row` of block `i` asks for: its constant and its drive's value.
   pure real(wp) function given(b, i, row, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, row
      type(state_t), intent(in) :: s

      associate (k => b%list(i)%first_row + row - 1)
         given = b%numbers%rows(k)%constant + s%drive_value(0, b%rows(k)%drive)
      end associate
   end function given

   !> What unknown number `u` of all, in column `column` of its block, is a multiple of: 1 of a direction of the block,
   !> a known direction otherwise.
   pure complex(wp) function direction_factor(column, u, s) result(factor)
      integer, intent(in) :: column, u
      type(state_t), intent(in) :: s

      factor = 1.0_wp
      if (column == 0) factor = cmplx(s%u(u)%c, s%u(u)%s, wp)
   end function direction_factor

   !> (0:n) Loop `m`, as a linear form of 1 and the `n` unknowns of a group.
   pure function linear_form(b, m, s, n) result(l)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m, n
      type(state_t), intent(in) :: s
      complex(wp) :: l(0:n), factor
      integer :: k

      l = 0.0_wp
      l(0) = cmplx(s%loop(m)%known(0)%x, s%loop(m)%known(0)%y, wp)
      do k = b%loops(m)%first_own, b%loops(m)%last_vector
         associate (d => b%body_vectors(k))
            l(d%column) = l(d%column) + direction_factor(d%column, d%orientation, s) &
               *cmplx(b%numbers%d(k)%x, b%numbers%d(k)%y, wp)
         end associate
      end do
      do k = b%loops(m)%first_slide, b%loops(m)%last_slide
         associate (e => b%slides(k))
            factor = direction_factor(e%orientation_column, e%orientation, s) &
               *cmplx(b%numbers%e(k)%x, b%numbers%e(k)%y, wp)
            if (e%column > 0) then
               l(e%column) = l(e%column) + factor
            else
               l(e%orientation_column) = l(e%orientation_column) + factor*s%u(e%unknown)%value
            end if
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
