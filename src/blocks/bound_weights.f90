!> By how much at most the unknowns of a block change with its equations, for `rounding_bounds`.
module bound_weights
   use kinds, only: wp
   use planar, only: vector_t
   use blocks, only: body_vector_t
   use block_matrix, only: solve_first, solve_many
   use block_state, only: unknown_t
   use block_equations, only: find_known_parts, assemble_block
   use block_engine, only: block_engine_t
   use rounding_parts, only: is_plain_dyad, dyad_jacobian
   use rounding_changes, only: rounding_response_t
   implicit none
   private
   public :: find_weights

contains

   !> By how much a change of 1 of each loop of block `i` changes each of its `n` unknowns at most, at `r%state`:
   !> `weights` (n, loops). Both rows of a loop are the components of a vector: it is the length of the two numbers of
   !> J^-1, `inverse` (n, n). `own`: the first own part of the first loop. `are_found`: the Jacobian has an inverse.
   subroutine find_weights(r, e, i, n, own, inverse, weights, are_found)
      type(rounding_response_t), intent(inout) :: r
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: i, n, own
      real(wp), intent(inout) :: inverse(n, n), weights(n, *)
      logical, intent(out) :: are_found
      integer :: k, j

      associate (first => e%blocks%list(i)%first_loop, last => e%blocks%list(i)%last_loop)
         if (is_plain_dyad(r%parts, e%blocks, e%blocks%list(i))) then
            associate (loop => e%blocks%loops(first))
               call weigh_dyad(e%blocks%body_vectors(loop%first_own:loop%last_vector), &
                  e%blocks%numbers%d(loop%first_own:loop%last_vector), &
                  r%parts%parts(own:own + 1)%length, r%state%u, weights, are_found)
            end associate
            return
         end if
         call find_inverse(r, e, i, n, inverse, are_found)
         do k = first, last
            associate (loop => e%blocks%loops(k))
               do j = 1, n
                  if (loop%row_x > 0 .and. loop%row_y > 0) then
                     weights(j, k - first + 1) = sqrt(inverse(j, loop%row_x)**2 + inverse(j, loop%row_y)**2)
                  else
                     weights(j, k - first + 1) = abs(inverse(j, max(loop%row_x, loop%row_y)))
                  end if
               end do
            end associate
         end do
      end associate
   end subroutine find_weights

   !> The same of a dyad whose own body vectors are `vectors`, of the lengths `length` (2).
   pure subroutine weigh_dyad(vectors, d, length, s, weights, are_found)
      type(body_vector_t), intent(in) :: vectors(2)
      type(vector_t), intent(in) :: d(2)
      real(wp), intent(in) :: length(2)
      type(unknown_t), intent(in) :: s(0:)
      real(wp), intent(inout) :: weights(2)
      logical, intent(out) :: are_found
      real(wp) :: a(4), area

      call dyad_jacobian(vectors, d, s, a)
      area = abs(a(1)*a(4) - a(2)*a(3))
      are_found = area > 0.0_wp
      if (.not. are_found) return
      weights(vectors(1)%column) = length(2)/area
      weights(vectors(2)%column) = length(1)/area
   end subroutine weigh_dyad

   !> The `inverse` (unknown, row) of the Jacobian of block `i`, which has `n` rows, at `r%state`. `is_found`: it has
   !> one.
   subroutine find_inverse(r, e, i, n, inverse, is_found)
      type(rounding_response_t), intent(inout) :: r
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: i, n
      real(wp), intent(inout) :: inverse(n, n)
      logical, intent(out) :: is_found
      integer :: info, k

      call find_known_parts(e%blocks, i, r%state)
      associate (shape => e%blocks%list(i)%shape, w => r%work, a => r%work%a)
         call assemble_block(e%blocks, i, r%state, a, w%r)
         info = 0
         select case (n)
         case (1)
            inverse(1, 1) = 1.0_wp/a(1)
         case (2)
            inverse(:, 1) = [a(4), -a(2)]/(a(1)*a(4) - a(2)*a(3))
            inverse(:, 2) = [-a(3), a(1)]/(a(1)*a(4) - a(2)*a(3))
         case default
            call solve_first(shape, a, w%sparse(0), w%pivots, w%work, w%r, info)
            inverse = 0.0_wp
            do k = 1, n
               inverse(k, k) = 1.0_wp
            end do
            if (info == 0) call solve_many(shape, a, w%sparse(0), w%pivots, w%work, n, inverse)
            inverse = transpose(inverse)
         end select
      end associate
      is_found = info == 0 .and. all(abs(inverse) <= huge(1.0_wp))
   end subroutine find_inverse
end module bound_weights
