!> Each vector loop in its own lengths: its rows, and the slides that its block solves for, in units of its largest
!> body vector. A residual, closure error or correction is then small or large for that loop and not for the largest
!> link of the mechanism. Units are powers of two: no digit changes.
!>
!> What a block knows may be much larger than its own body vectors. Its rounding cannot be corrected: `coarse` says how
!> much larger it is, and levels of rounding are that much higher.
module block_units
   use kinds, only: wp
   use scales, only: power_of_two
   use blocks, only: blocks_t, block_loop_t, body_vector_t, loop_angles, loop_projection
   use block_loops, only: lipschitz_of
   implicit none
   private
   public :: find_units

   real(wp), parameter :: much_smaller = 0.0625_wp

contains

   !> Divides the rows of all blocks of `b`, filled in one unit of length, by units of their own, and its slides.
   pure subroutine find_units(b)
      type(blocks_t), intent(inout) :: b
      integer :: i, m

      do i = 1, size(b%list)
         associate (first => b%list(i)%first_loop, last => b%list(i)%last_loop)
            do m = first, last
               call measure(b, m)
            end do
            call make_alike(b%loops(first:last))
            call measure_slides(b, i)
            do m = first, last
               call divide(b, b%list(i)%first_row, m)
            end do
            b%list(i)%lipschitz = lipschitz_of(b, b%list(i))
            b%list(i)%coarse = max(1.0_wp, maxval(b%loops(first:last)%coarse))
         end associate
      end do
   end subroutine find_units

   !> Unit of loop `m`: its largest own body vector. A slide is as long as what is known lets it be, and a projection
   !> that turns with an orientation of the block turns the whole loop.
   pure subroutine measure(b, m)
      type(blocks_t), intent(inout) :: b
      integer, intent(in) :: m
      real(wp) :: own, known
      integer :: k

      associate (g => b%loops(m))
         if (g%kind == loop_angles) return
         known = max(maxval(abs(g%ground)), largest(b%body_vectors(g%first_vector:g%first_own - 1)))
         own = largest(b%body_vectors(g%first_own:g%last_vector))
         do k = g%first_slide, g%last_slide
            if (b%slides(k)%column == 0) known = max(known, b%unit(b%slides(k)%unknown))
         end do
         if (own <= 0.0_wp .or. any(b%slides(g%first_slide:g%last_slide)%column > 0) .or. &
            (g%kind == loop_projection .and. g%orientation_column > 0)) own = max(own, known)
         if (own > 0.0_wp) g%unit = power_of_two(own)
         g%coarse = known
      end associate
   end subroutine measure

   !> The largest component of `vectors`; 0 of none.
   pure real(wp) function largest(vectors)
      type(body_vector_t), intent(in) :: vectors(:)

      largest = max(0.0_wp, maxval(abs(vectors%x)), maxval(abs(vectors%y)))
   end function largest

   !> Loops `g` of one block that are not much smaller than the largest get its unit: the weights of their rows are then
   !> the same where equations are too many. What is known is from now on in the loop's unit.
   pure subroutine make_alike(g)
      type(block_loop_t), intent(inout) :: g(:)
      real(wp) :: largest
      integer :: m

      largest = maxval(g%unit, mask=g%kind /= loop_angles)
      do m = 1, size(g)
         if (g(m)%kind == loop_angles) cycle
         if (g(m)%unit >= much_smaller*largest) g(m)%unit = largest
         g(m)%coarse = max(1.0_wp, g(m)%coarse/g(m)%unit)
      end do
   end subroutine make_alike

   !> Units of the slides that block `i` solves for: that of the largest loop in which each stands.
   pure subroutine measure_slides(b, i)
      type(blocks_t), intent(inout) :: b
      integer, intent(in) :: i
      integer :: m, k
      logical :: met(0:merge(b%unknowns, 0, size(b%slides) > 0))

      met = .false.
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            do k = g%first_slide, g%last_slide
               if (b%slides(k)%column == 0) cycle
               associate (u => b%slides(k)%unknown)
                  if (met(u)) then
                     b%unit(u) = max(b%unit(u), g%unit)
                  else
                     b%unit(u) = g%unit
                  end if
                  met(u) = .true.
               end associate
            end do
         end associate
      end do
   end subroutine measure_slides

   !> Divides the rows of loop `m`, of the block whose rows begin at `first_row`, by its unit.
   pure subroutine divide(b, first_row, m)
      type(blocks_t), intent(inout) :: b
      integer, intent(in) :: first_row, m
      integer :: k, side

      associate (g => b%loops(m))
         ! A slide by itself.
         if (g%kind == loop_angles) g%unit = b%unit(g%orientation)
         do side = 1, 2
            k = merge(g%row_x, g%row_y, side == 1)
            if (k == 0) cycle
            associate (row => b%rows(first_row + k - 1))
               row%unit = g%unit
               row%constant = row%constant/g%unit
            end associate
         end do
         if (g%kind == loop_angles) return
         g%ground = g%ground/g%unit
         b%body_vectors(g%first_vector:g%last_vector)%x = b%body_vectors(g%first_vector:g%last_vector)%x/g%unit
         b%body_vectors(g%first_vector:g%last_vector)%y = b%body_vectors(g%first_vector:g%last_vector)%y/g%unit
         do k = g%first_slide, g%last_slide
            b%slides(k)%body_vector = b%slides(k)%body_vector*(b%unit(b%slides(k)%unknown)/g%unit)
         end do
      end associate
   end subroutine divide

end module block_units
