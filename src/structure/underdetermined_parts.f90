!> Unknowns that have too few equations, part by part.
module underdetermined_parts
   use matching, only: incidence_t, overdetermined
   implicit none
   private
   public :: underdetermined

contains

   !> (unknowns) What has too few equations: 0 for what is determined; the others have the number of the first free
   !> unknown that equations join them with. It is in no other equations.
   function underdetermined(g, unknown_of, equation_of) result(part)
      type(incidence_t), intent(in) :: g
      integer, intent(in) :: unknown_of(:), equation_of(:)
      integer :: part(g%unknowns)
      type(incidence_t) :: h
      integer :: u
      logical :: loose(g%unknowns)

      h = turned_round(g)
      ! Turned round, too few equations are too many: those that could be free in place of the free ones.
      loose = overdetermined(h, equation_of, unknown_of)
      part = 0
      do u = 1, g%unknowns
         if (equation_of(u) == 0 .and. part(u) == 0) call spread(g, h, u, loose, part)
      end do
   end function underdetermined

   !> The equations of each unknown.
   pure function turned_round(g) result(h)
      type(incidence_t), intent(in) :: g
      type(incidence_t) :: h
      integer :: fill(g%unknowns), e, i

      h%equations = g%unknowns
      h%unknowns = g%equations
      allocate (h%first(g%unknowns + 1), h%unknown(g%first(g%equations + 1) - 1))
      fill = 0
      do i = 1, size(h%unknown)
         fill(g%unknown(i)) = fill(g%unknown(i)) + 1
      end do
      h%first(1) = 1
      do i = 1, g%unknowns
         h%first(i + 1) = h%first(i) + fill(i)
      end do
      fill = h%first(:g%unknowns)
      do e = 1, g%equations
         do i = g%first(e), g%first(e + 1) - 1
            h%unknown(fill(g%unknown(i))) = e
            fill(g%unknown(i)) = fill(g%unknown(i)) + 1
         end do
      end do
   end function turned_round

   !> Gives number `start` to all loose unknowns that equations join with it, one after another.
   pure subroutine spread(g, h, start, loose, part)
      type(incidence_t), intent(in) :: g, h
      integer, intent(in) :: start
      logical, intent(in) :: loose(:)
      integer, intent(inout) :: part(:)
      integer, allocatable :: stack(:)
      integer :: i, k, u, top

      allocate (stack(64))
      top = 1
      stack(1) = start
      part(start) = start
      do while (top > 0)
         u = stack(top)
         top = top - 1
         do i = h%first(u), h%first(u + 1) - 1
            do k = g%first(h%unknown(i)), g%first(h%unknown(i) + 1) - 1
               if (.not. loose(g%unknown(k)) .or. part(g%unknown(k)) > 0) cycle
               part(g%unknown(k)) = start
               if (top == size(stack)) stack = [stack, stack]
               top = top + 1
               stack(top) = g%unknown(k)
            end do
         end do
      end do
   end subroutine spread
end module underdetermined_parts
