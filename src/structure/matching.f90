!> A largest matching of equations with unknowns, and what follows from it: the blocks, the equations that are too many,
!> and the unknowns with too few. Which unknown is in which equation is all that is looked at.
!>
!> Matching: augmenting paths, depth first with a look ahead (Duff, ACM TOMS 7, 1981). Blocks: the strongly connected
!> components of the graph in which an equation points to those that its other unknowns are matched with (Tarjan,
!> SIAM J. Comput. 1, 1972; Duff and Reid, ACM TOMS 4, 1978), without recursion. Parts with too many or too few
!> equations: Dulmage and Mendelsohn, Can. J. Math. 10, 1958.
!>
!> Rejected: btf_maxtrans, btf_strongcomp and cs_dmperm of SuiteSparse. They find the same blocks, but with the unknowns
!> of a block in other orders, and with these the last digits of results change in 5 to 35 of 56 decks.
module matching
   use grouping, only: sorted_t, sorted
   implicit none
   private
   public :: incidence_t, owners, match, find_blocks, overdetermined, underdetermined

   !> Unknowns of equation e: unknown(first(e)), ..., unknown(first(e + 1) - 1), each once.
   type :: incidence_t
      integer :: equations = 0, unknowns = 0
      integer, allocatable :: first(:), unknown(:)
   end type incidence_t

contains

   !> The equation of each entry of g%unknown.
   pure function owners(g) result(equation)
      type(incidence_t), intent(in) :: g
      integer :: equation(g%first(g%equations + 1) - 1), e

      do e = 1, g%equations
         equation(g%first(e):g%first(e + 1) - 1) = e
      end do
   end function owners

   !> `unknown_of` (equations): the unknown matched with each equation, 0 for none; `equation_of` (unknowns) likewise.
   subroutine match(g, unknown_of, equation_of)
      type(incidence_t), intent(in) :: g
      integer, allocatable, intent(out) :: unknown_of(:), equation_of(:)
      ! Of each equation: where the look ahead for a free unknown stands, never set back, and the last search that came
      ! to it. Of the search at hand: its path of equations, and the place of the next unknown of each.
      integer :: look(g%equations), seen(g%equations), path(g%equations), next(g%equations)
      integer :: i, e

      allocate (unknown_of(g%equations), equation_of(g%unknowns), source=0)
      do e = 1, g%equations
         do i = g%first(e), g%first(e + 1) - 1
            if (equation_of(g%unknown(i)) /= 0) cycle
            call join(e, g%unknown(i))
            exit
         end do
      end do
      look = g%first(:g%equations)
      seen = 0
      do e = 1, g%equations
         if (unknown_of(e) == 0) call augment(e)
      end do

   contains

      !> Matches equation `e` with unknown `u`.
      subroutine join(e, u)
         integer, intent(in) :: e, u

         unknown_of(e) = u
         equation_of(u) = e
      end subroutine join

      !> Looks for a path from equation `start` to a free unknown. Every equation of it takes the unknown of the one
      !> after it, the last the free one.
      subroutine augment(start)
         integer, intent(in) :: start
         integer :: depth, free

         depth = 0
         call visit(start, start, depth)
         do while (depth > 0)
            free = free_unknown(path(depth))
            if (free > 0) exit
            call go_deeper(start, depth)
         end do
         if (depth == 0) return
         call join(path(depth), free)
         do depth = depth - 1, 1, -1
            call join(path(depth), g%unknown(next(depth) - 1))
         end do
      end subroutine augment

      !> The path of search `number` goes on to equation `e`.
      subroutine visit(e, number, depth)
         integer, intent(in) :: e, number
         integer, intent(inout) :: depth

         depth = depth + 1
         path(depth) = e
         next(depth) = g%first(e)
         seen(e) = number
      end subroutine visit

      !> A free unknown of equation `e`, 0 for none.
      integer function free_unknown(e) result(u)
         integer, intent(in) :: e

         do while (look(e) < g%first(e + 1))
            u = g%unknown(look(e))
            look(e) = look(e) + 1
            if (equation_of(u) == 0) return
         end do
         u = 0
      end function free_unknown

      !> One step of search `number`: to an equation not yet seen, or back.
      subroutine go_deeper(number, depth)
         integer, intent(in) :: number
         integer, intent(inout) :: depth
         integer :: e

         do while (next(depth) < g%first(path(depth) + 1))
            e = equation_of(g%unknown(next(depth)))
            next(depth) = next(depth) + 1
            if (seen(e) == number) cycle
            call visit(e, number, depth)
            return
         end do
         depth = depth - 1
      end subroutine go_deeper
   end subroutine match

   !> The blocks of a perfect matching: equations `member`(first(b)), ..., member(first(b + 1) - 1) are block b,
   !> solved for the unknowns matched with them. A block needs unknowns of earlier blocks only. No equation: no
   !> block.
   subroutine find_blocks(g, equation_of, first, member, skip)
      type(incidence_t), intent(in) :: g
      integer, intent(in) :: equation_of(:)
      integer, allocatable, intent(out) :: first(:), member(:)
      logical, intent(in), optional :: skip(:)
      integer :: number(g%equations), low(g%equations), path(g%equations), next(g%equations)
      integer :: stack(g%equations), counter, depth, top, blocks, members, root, e, further

      number = 0
      if (present(skip)) number = merge(huge(1), 0, skip)
      counter = 0
      top = 0
      blocks = 0
      members = 0
      allocate (first(g%equations + 1), member(g%equations))
      first(1) = 1
      do root = 1, g%equations
         if (number(root) > 0) cycle
         depth = 1
         path(1) = root
         call enter(root)
         do while (depth > 0)
            e = path(depth)
            further = next_equation(e)
            if (further > 0) then
               if (number(further) == 0) then
                  depth = depth + 1
                  path(depth) = further
                  call enter(further)
               else if (number(further) > 0) then
                  low(e) = min(low(e), number(further))
               end if
            else
               depth = depth - 1
               if (depth > 0) low(path(depth)) = min(low(path(depth)), low(e))
               if (low(e) == number(e)) call close_block(e)
            end if
         end do
      end do
      first = first(:blocks + 1)
      member = member(:members)

   contains

      !> The search comes to equation `e`.
      subroutine enter(e)
         integer, intent(in) :: e

         counter = counter + 1
         number(e) = counter
         low(e) = counter
         next(e) = g%first(e)
         top = top + 1
         stack(top) = e
      end subroutine enter

      !> The next equation that `e` waits for and that belongs to no block yet, 0 for none.
      integer function next_equation(e) result(other)
         integer, intent(in) :: e

         do while (next(e) < g%first(e + 1))
            other = equation_of(g%unknown(next(e)))
            next(e) = next(e) + 1
            if (other /= e .and. number(other) < huge(1)) return
         end do
         other = 0
      end function next_equation

      !> All that stands on the stack down to `e` is one block.
      subroutine close_block(e)
         integer, intent(in) :: e
         integer :: last

         do
            last = stack(top)
            top = top - 1
            number(last) = huge(1)
            members = members + 1
            member(members) = last
            if (last == e) exit
         end do
         blocks = blocks + 1
         first(blocks + 1) = members + 1
      end subroutine close_block
   end subroutine find_blocks

   !> (equations) The part with too many equations, of a largest matching: those without an unknown, and all that
   !> stand for unknowns of theirs, again and again. It needs no other unknowns.
   function overdetermined(g, unknown_of, equation_of) result(over)
      type(incidence_t), intent(in) :: g
      integer, intent(in) :: unknown_of(:), equation_of(:)
      logical :: over(g%equations)
      integer :: queue(g%equations), last, next, i, e

      over = unknown_of == 0
      if (.not. any(over)) return
      queue = 0
      last = count(over)
      queue(:last) = pack([(i, i=1, g%equations)], over)
      next = 1
      do while (next <= last)
         do i = g%first(queue(next)), g%first(queue(next) + 1) - 1
            e = equation_of(g%unknown(i))
            if (over(e)) cycle
            over(e) = .true.
            last = last + 1
            queue(last) = e
         end do
         next = next + 1
      end do
   end function overdetermined

   !> (unknowns) The part with too few equations, of a largest matching: the free unknowns, and all that could be free
   !> in their place. Turned round, too few equations are too many.
   function underdetermined(g, unknown_of, equation_of) result(loose)
      type(incidence_t), intent(in) :: g
      integer, intent(in) :: unknown_of(:), equation_of(:)
      logical :: loose(g%unknowns)
      integer :: owner(g%first(g%equations + 1) - 1)
      type(sorted_t) :: s

      owner = owners(g)
      s = sorted(g%unknown(:size(owner)), g%unknowns)
      loose = overdetermined(incidence_t(g%unknowns, g%equations, s%first, owner(s%member)), equation_of, unknown_of)
   end function underdetermined
end module matching
