!> A largest matching of equations with unknowns, and its consequences: the blocks, the equations that are too many,
!> and the unknowns with too few. The only data are which unknown is in which equation.
!>
!> Matching: augmenting paths, depth first with a look ahead (Duff, ACM TOMS 7, 1981). Blocks: the strongly connected
!> components of the graph in which an equation points to those that its other unknowns are matched with (Tarjan,
!> SIAM J. Comput. 1, 1972; Duff and Reid, ACM TOMS 4, 1978), without recursion. Parts with too many or too few
!> equations: Dulmage and Mendelsohn, Can. J. Math. 10, 1958.
!>
!> Rejected: btf_maxtrans, btf_strongcomp and cs_dmperm of SuiteSparse. They find the same blocks, but with the unknowns
!> of a block in other orders, and with these the last digits of results change in 5 to 35 of 56 decks.
module matching
   use disjoint_sets, only: sorted_t, sorted
   implicit none
   private
   public :: incidence_t, match, find_blocks, overdetermined, underdetermined

   !> Unknowns of equation e: unknown(first(e)), ..., unknown(first(e + 1) - 1), each once.
   type :: incidence_t
      integer :: equations = 0, unknowns = 0      !< how many there are
      integer, allocatable :: first(:), unknown(:)   !< (equations + 1), (all unknowns of all equations)
   end type incidence_t

contains

   !> Finds a largest matching of equations with unknowns.
   subroutine match(incidence, unknown_of, equation_of)
      type(incidence_t), intent(in) :: incidence   !< which unknown is in which equation
      integer, allocatable, intent(out) :: unknown_of(:)    !< (equations) the unknown matched with each; 0: none
      integer, allocatable, intent(out) :: equation_of(:)   !< (unknowns) the equation matched with each; 0: none
      ! (equations) look: the index of the next unknown in the look ahead, never set back; seen: the last search that
      ! came to it. Of one search: its path of equations, and of each equation the index of its next unknown.
      integer :: look(incidence%equations), seen(incidence%equations), path(incidence%equations), &
         next(incidence%equations)
      integer :: i, e

      allocate (unknown_of(incidence%equations), equation_of(incidence%unknowns), source=0)
      do e = 1, incidence%equations
         do i = incidence%first(e), incidence%first(e + 1) - 1
            if (equation_of(incidence%unknown(i)) /= 0) cycle
            call join(e, incidence%unknown(i))
            exit
         end do
      end do
      look = incidence%first(:incidence%equations)
      seen = 0
      do e = 1, incidence%equations
         if (unknown_of(e) == 0) call augment(e)
      end do

   contains

      !> Matches an equation with an unknown, in both lists.
      subroutine join(equation, unknown)
         integer, intent(in) :: equation     !< its number
         integer, intent(in) :: unknown      !< its number

         unknown_of(equation) = unknown
         equation_of(unknown) = equation
      end subroutine join

      !> Looks for a path from an equation to a free unknown. Every equation on the path takes the unknown of the one
      !> after it, the last one the free unknown. Without such a path the matching stays.
      subroutine augment(start)
         integer, intent(in) :: start        !< the number of the equation, which has no unknown
         integer :: depth, e, u

         depth = 0
         e = start
         do
            if (e > 0) then
               ! Go on to equation `e`, which this search has not seen.
               depth = depth + 1
               path(depth) = e
               next(depth) = incidence%first(e)
               seen(e) = start

               do while (look(e) < incidence%first(e + 1))
                  u = incidence%unknown(look(e))
                  look(e) = look(e) + 1
                  if (equation_of(u) == 0) then
                     call join(e, u)
                     do depth = depth - 1, 1, -1
                        call join(path(depth), incidence%unknown(next(depth) - 1))
                     end do
                     return
                  end if
               end do
            else
               depth = depth - 1
               if (depth == 0) return
            end if

            e = 0
            do while (next(depth) < incidence%first(path(depth) + 1) .and. e == 0)
               e = equation_of(incidence%unknown(next(depth)))
               next(depth) = next(depth) + 1
               if (seen(e) == start) e = 0
            end do
         end do
      end subroutine augment
   end subroutine match

   !> Finds the blocks of a matching that gives each unknown an equation. Equations member(first(k)), ...,
   !> member(first(k + 1) - 1) are block k, solved for the unknowns matched with them. A block needs unknowns of earlier
   !> blocks only, and unknowns of the equations left out. Without equations there is no block.
   subroutine find_blocks(incidence, equation_of, skip, first, member)
      type(incidence_t), intent(in) :: incidence   !< which unknown is in which equation
      integer, intent(in) :: equation_of(:)  !< (unknowns) the equation matched with each, never 0
      logical, intent(in) :: skip(:)         !< (equations) the equation belongs to no block
      integer, allocatable, intent(out) :: first(:)    !< (blocks + 1) where each block begins in `member`
      integer, allocatable, intent(out) :: member(:)   !< (equations not left out) numbers, by block in solving order
      integer, parameter :: done = huge(1)   !< the number of an equation whose block is complete; above all others
      integer :: number(incidence%equations), low(incidence%equations), path(incidence%equations), &
         next(incidence%equations)
      integer :: stack(incidence%equations), counter, depth, top, blocks, members, root, e, other

      number = merge(done, 0, skip)
      counter = 0
      top = 0
      blocks = 0
      members = 0
      allocate (first(incidence%equations + 1), member(incidence%equations))
      first(1) = 1

      do root = 1, incidence%equations
         if (number(root) > 0) cycle
         depth = 0
         call enter(root)
         do while (depth > 0)
            e = path(depth)

            ! The next equation that `e` waits for and that belongs to no block yet.
            if (next(e) < incidence%first(e + 1)) then
               other = equation_of(incidence%unknown(next(e)))
               next(e) = next(e) + 1
               if (number(other) == 0) then
                  call enter(other)
               else if (number(other) < done) then
                  low(e) = min(low(e), number(other))
               end if
               cycle
            end if

            ! `e` waits for no more: the equations on the stack down to `e` may be one block.
            depth = depth - 1
            if (depth > 0) low(path(depth)) = min(low(path(depth)), low(e))
            if (low(e) < number(e)) cycle
            do
               other = stack(top)
               top = top - 1
               number(other) = done
               members = members + 1
               member(members) = other
               if (other == e) exit
            end do
            blocks = blocks + 1
            first(blocks + 1) = members + 1
         end do
      end do
      first = first(:blocks + 1)
      member = member(:members)

   contains

      !> Puts an equation to which the search has come on path and stack, with the next number.
      subroutine enter(equation)
         integer, intent(in) :: equation     !< its number

         depth = depth + 1
         path(depth) = equation
         counter = counter + 1
         number(equation) = counter
         low(equation) = counter
         next(equation) = incidence%first(equation)
         top = top + 1
         stack(top) = equation
      end subroutine enter
   end subroutine find_blocks

   !> Finds the part with too many equations (equations): those without an unknown, and all that are matched with
   !> unknowns of equations of the part. The part needs no other unknowns.
   function overdetermined(incidence, unknown_of, equation_of) result(over)
      type(incidence_t), intent(in) :: incidence   !< which unknown is in which equation
      integer, intent(in) :: unknown_of(:)   !< (equations) the unknown of each in a largest matching; 0: none
      integer, intent(in) :: equation_of(:)  !< (unknowns) the equation of each in the matching; 0: none
      logical :: over(incidence%equations)
      integer :: queue(incidence%equations), last, next, i, e

      over = unknown_of == 0
      if (.not. any(over)) return
      queue = 0
      last = count(over)
      queue(:last) = pack([(i, i=1, incidence%equations)], over)
      next = 1
      do while (next <= last)
         do i = incidence%first(queue(next)), incidence%first(queue(next) + 1) - 1
            e = equation_of(incidence%unknown(i))
            if (over(e)) cycle
            over(e) = .true.
            last = last + 1
            queue(last) = e
         end do
         next = next + 1
      end do
   end function overdetermined

   !> Finds the part with too few equations (unknowns): the free unknowns, and all that another largest matching could
   !> leave free. With equations and unknowns exchanged it is the part with too many equations.
   function underdetermined(incidence, unknown_of, equation_of) result(loose)
      type(incidence_t), intent(in) :: incidence   !< which unknown is in which equation
      integer, intent(in) :: unknown_of(:)   !< (equations) the unknown of each in a largest matching; 0: none
      integer, intent(in) :: equation_of(:)  !< (unknowns) the equation of each in the matching; 0: none
      logical :: loose(incidence%unknowns)
      integer :: owner(incidence%first(incidence%equations + 1) - 1), e
      type(sorted_t) :: s

      do e = 1, incidence%equations
         owner(incidence%first(e):incidence%first(e + 1) - 1) = e
      end do
      s = sorted(incidence%unknown(:size(owner)), incidence%unknowns)
      loose = overdetermined(incidence_t(incidence%unknowns, incidence%equations, s%first, owner(s%member)), &
         equation_of, unknown_of)
   end function underdetermined
end module matching
