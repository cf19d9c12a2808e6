!> What roundings change of the equations of a block, in all directions of `card_roundings` at once.
module rounding_residuals
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use blocks, only: blocks_t, block_t, block_loop_t, row_t, loop_projection
   use rounding_changes, only: rounding_response_t, change_loop, add_found_angles
   use card_roundings, only: directions, rounding, number_pair, number_drive, parts_of_number, add_own
   implicit none
   private
   public :: find_residuals, change_of_constant

contains

   !> `r%v` (directions, rows): derivative number `order` of the changes of the equations of `block`, with the other
   !> sign, as far as they are known. `m`: on whose pairs' guides drives measure.
   subroutine find_residuals(r, m, b, block, order)
      type(rounding_response_t), intent(inout) :: r
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(in) :: b
      type(block_t), intent(in) :: block
      integer, intent(in) :: order
      integer :: k, j

      do k = block%first_loop, block%last_loop
         j = k - block%first_loop + 1
         associate (loop => b%loops(k), p => r%parts)
            ! What is found of the block's own angles turns its own vectors; all else is as it was.
            if (order == 0 .or. .not. p%is_plain(k)) then
               call change_loop(r, b, k, guide_of(loop), r%g(:, :, :, j), r%loop_size(:, j))
            else
               call add_found_angles(order - 1, p%first_own(k), p%first(k + 1) - 1, p%parts, r%state%u, r%u, &
                  r%g(:, :, :, j))
            end if
            if (loop%row_x > 0) call set_row(loop%row_x, r%g(:, 1, order, j), r%loop_size(order, j))
            if (loop%row_y > 0) call set_row(loop%row_y, r%g(:, 2, order, j), r%loop_size(order, j))
         end associate
      end do
      ! Orthogonal factors mix all rows.
      if (block%shape%rows > block%shape%n) r%row_size(:block%shape%rows) = maxval(r%row_size(:block%shape%rows))
      do k = 1, block%shape%rows
         call add_own(r%own*r%row_size(k), 3*(block%first_row + k - 1) + order, r%v(:, k))
      end do

   contains

      !> The prismatic pair on whose guide `loop`, or the slide of its drive, is measured; 0: it is no projection.
      pure integer function guide_of(loop)
         type(block_loop_t), intent(in) :: loop

         guide_of = 0
         if (loop%kind /= loop_projection) return
         associate (row => b%rows(block%first_row + loop%row_x - 1))
            guide_of = row%pair
            if (row%pair == 0) guide_of = m%drives(row%drive)%subject
         end associate
      end function guide_of

      !> Row number `row`: the change of its drive, and of its constant, less that of its loop, `x`.
      subroutine set_row(row, x, size_of)
         integer, intent(in) :: row
         real(wp), intent(in) :: x(directions), size_of

         associate (own => b%rows(block%first_row + row - 1))
            call subtract(x, r%drive(:, order, own%drive), r%v(:, row))
            associate (constant => b%numbers%rows(block%first_row + row - 1)%constant)
               if (order == 0 .and. abs(constant) > 0.0_wp) &
                  r%v(:, row) = r%v(:, row) + change_of_constant(own, constant)
            end associate
         end associate
         r%row_size(row) = size_of
      end subroutine set_row
   end subroutine find_residuals

   !> `z` = `y` - `x` (directions).
   pure subroutine subtract(x, y, z)
      real(wp), intent(in) :: x(directions), y(directions)
      real(wp), intent(inout) :: z(directions)

      z = y - x
   end subroutine subtract

   !> By how much the `constant` of `row` is off (directions): a sum of angles of the deck, or the offset of a guide.
   pure function change_of_constant(row, constant) result(change)
      type(row_t), intent(in) :: row
      real(wp), intent(in) :: constant
      real(wp) :: change(directions)

      change = rounding*abs(constant)*parts_of_number(merge(number_drive, number_pair, row%drive > 0), &
         max(row%drive, row%pair), 0)
   end function change_of_constant
end module rounding_residuals
