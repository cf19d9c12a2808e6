!> Level 2. The order of equations and unknowns within a large block that keeps its Jacobian in a narrow band: reverse
!> Cuthill-McKee on the pattern of A + A' (Cuthill and McKee 1969; George and Liu, Computer Solution of Large Sparse
!> Positive Definite Systems, 1981), equation and matched unknown moved together.
module band_order
   use matching, only: incidence_t
   implicit none
   private
   public :: order_block, band_of

   !> Blocks smaller than this stay dense: DGBTRF is slower there (`make bench`, lattice).
   integer, parameter :: least_band = 24

   !> Neighbours of row r: near(first(r)), ..., near(first(r + 1) - 1).
   type :: graph_t
      integer, allocatable :: first(:), near(:)
   end type graph_t

contains

   !> Puts the equations `member` of one block in the order of a narrow band. `equation_of` (unknowns): the matching.
   subroutine order_block(g, equation_of, member)
      type(incidence_t), intent(in) :: g
      integer, intent(in) :: equation_of(:)
      integer, intent(inout) :: member(:)
      type(graph_t) :: graph
      integer :: order(size(member))

      if (size(member) < least_band) return
      graph = pattern(g, equation_of, member)
      order = 0
      call walk(graph, 1, order)
      ! A row far from where a walk ends is a good end to begin at: two more walks.
      call walk(graph, order(size(order)), order)
      call walk(graph, order(size(order)), order)
      member = member(order(size(order):1:-1))
   end subroutine order_block

   !> The pattern of A + A' of the block.
   function pattern(g, equation_of, member) result(graph)
      type(incidence_t), intent(in) :: g
      integer, intent(in) :: equation_of(:), member(:)
      type(graph_t) :: graph
      integer :: row_of(g%equations), fill(size(member)), pass, r, c, i

      row_of = 0
      do r = 1, size(member)
         row_of(member(r)) = r
      end do
      allocate (graph%first(size(member) + 1))
      graph%first(1) = 1
      do pass = 1, 2
         if (pass == 2) then
            do r = 1, size(member)
               graph%first(r + 1) = graph%first(r) + fill(r)
            end do
            allocate (graph%near(graph%first(size(member) + 1) - 1))
         end if
         fill = 0
         do r = 1, size(member)
            do i = g%first(member(r)), g%first(member(r) + 1) - 1
               c = row_of(equation_of(g%unknown(i)))
               if (c == 0 .or. c == r) cycle
               if (pass == 2) then
                  graph%near(graph%first(r) + fill(r)) = c
                  graph%near(graph%first(c) + fill(c)) = r
               end if
               fill(r) = fill(r) + 1
               fill(c) = fill(c) + 1
            end do
         end do
      end do
   end function pattern

   !> Breadth first from row `start`, of a row's neighbours those with few neighbours first.
   subroutine walk(graph, start, order)
      type(graph_t), intent(in) :: graph
      integer, intent(in) :: start
      integer, intent(inout) :: order(:)
      logical :: seen(size(order))
      integer :: last, next, begin, row, i

      row = start
      seen = .false.
      seen(row) = .true.
      order(1) = row
      last = 1
      next = 1
      do while (next <= last)
         row = order(next)
         next = next + 1
         begin = last + 1
         do i = graph%first(row), graph%first(row + 1) - 1
            if (seen(graph%near(i))) cycle
            seen(graph%near(i)) = .true.
            last = last + 1
            order(last) = graph%near(i)
         end do
         call sort_by_degree(graph, order(begin:last))
      end do
   end subroutine walk

   !> By insertion: neighbours are few.
   pure subroutine sort_by_degree(graph, rows)
      type(graph_t), intent(in) :: graph
      integer, intent(inout) :: rows(:)
      integer :: i, k, row

      do i = 2, size(rows)
         row = rows(i)
         k = i - 1
         do while (k >= 1)
            if (degree(graph, rows(k)) <= degree(graph, row)) exit
            rows(k + 1) = rows(k)
            k = k - 1
         end do
         rows(k + 1) = row
      end do
   end subroutine sort_by_degree

   pure integer function degree(graph, row)
      type(graph_t), intent(in) :: graph
      integer, intent(in) :: row

      degree = graph%first(row + 1) - graph%first(row)
   end function degree

   !> Diagonals `below` and `above` the main one that hold the block; -1 where a dense matrix is the better choice.
   pure subroutine band_of(g, equation_of, member, below, above)
      type(incidence_t), intent(in) :: g
      integer, intent(in) :: equation_of(:), member(:)
      integer, intent(out) :: below, above
      integer :: row_of(merge(g%equations, 0, size(member) >= least_band)), r, c, i

      below = -1
      above = -1
      if (size(member) < least_band) return
      row_of = 0
      do r = 1, size(member)
         row_of(member(r)) = r
      end do
      below = 0
      above = 0
      do r = 1, size(member)
         do i = g%first(member(r)), g%first(member(r) + 1) - 1
            c = row_of(equation_of(g%unknown(i)))
            if (c == 0) cycle
            below = max(below, r - c)
            above = max(above, c - r)
         end do
      end do
      ! With pivoting the upper band grows by the lower one. Up to here the band is not slower than the dense matrix.
      ! (Lattices, reference LAPACK and OpenBLAS.)
      if (2*(2*below + above + 1) <= 3*size(member)) return
      below = -1
      above = -1
   end subroutine band_of
end module band_order
