!> Tests. One mechanism by blocks and by all closure equations at once, instant by instant.
module compare_engines
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_dense, wanted_links
   use motion, only: motion_t, new_motion, flag_none
   use structure, only: structure_report_t, find_structure
   use analysis, only: analysis_t, make_analysis, advance
   implicit none
   private
   public :: comparison_t, compare

   !> How far the two are apart, as a share of what rounding may do.
   type :: comparison_t
      integer :: solved = 0             !< instants that both found
      integer :: only_blocks = 0, only_dense = 0
      real(wp) :: share(0:2) = 0.0_wp   !< position, velocity, acceleration: largest
      real(wp) :: time = 0.0_wp         !< of the largest share
      real(wp) :: condition = 1.0_wp    !< reciprocal, there
   end type comparison_t

contains

   !> `m` at the instants `t`, all at once by `method` (METHOD DENSE); at none but the first where that has no motion, at none
   !> where the structure has no solution.
   function compare(m, t, method) result(c)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: t(:)
      integer, intent(in), optional :: method
      type(comparison_t) :: c
      type(mechanism_t) :: all_at_once
      type(analysis_t) :: blocks, dense
      type(motion_t) :: q, r
      type(structure_report_t) :: f
      real(wp) :: share(0:2)
      integer :: k

      f = find_structure(m)
      if (.not. f%solvable) return
      all_at_once = m
      all_at_once%method = method_dense
      if (present(method)) all_at_once%method = method
      call make_analysis(blocks, m)
      call make_analysis(dense, all_at_once)
      q = new_motion(size(m%links))
      r = q
      do k = 1, size(t)
         call advance(blocks, t(k), q)
         call advance(dense, t(k), r)
         ! Where there is no motion to begin with, later assemblies are anyone's choice.
         if (k == 1 .and. (q%flag /= flag_none .or. r%flag /= flag_none)) exit
         if (q%flag == flag_none .and. r%flag == flag_none) then
            c%solved = c%solved + 1
            share = apart(q, r, wanted_links(m), dense%geometry%equations%length, &
               0.1_wp*dense%convergence%min_pivot)
            if (maxval(share) > maxval(c%share)) then
               c%time = t(k)
               c%condition = 0.1_wp*dense%convergence%min_pivot
            end if
            c%share = max(c%share, share)
         else if (q%flag == flag_none) then
            c%only_blocks = c%only_blocks + 1
         else if (r%flag == flag_none) then
            c%only_dense = c%only_dense + 1
         end if
      end do
   end function compare

   !> Differences of the `wanted` links over their bounds. With k the condition of the dense Jacobian, ten times the ratio of its
   !> pivots, positions are known to k eps, velocities v to k times (eps + what that does to the Jacobian) times v, accelerations
   !> once more; lengths in the system's unit.
   function apart(q, r, wanted, length, reciprocal_condition) result(share)
      type(motion_t), intent(in) :: q, r
      logical, intent(in) :: wanted(:)
      real(wp), intent(in) :: length, reciprocal_condition
      real(wp) :: share(0:2), bound(0:2), v, a
      logical :: all_links(size(wanted))

      all_links = .true.
      bound(0) = max(1.0_wp, largest(r%position, all_links, length))*epsilon(1.0_wp)/reciprocal_condition
      v = largest(r%velocity, all_links, length)
      a = largest(r%acceleration, all_links, length)
      bound(1) = bound(0)/reciprocal_condition*v + tiny(v)
      bound(2) = bound(0)/reciprocal_condition*(a + v*v) + bound(1)/reciprocal_condition*v + tiny(v)
      share(0) = largest(q%position - r%position, wanted, length)/bound(0)
      share(1) = largest(q%velocity - r%velocity, wanted, length)/bound(1)
      share(2) = largest(q%acceleration - r%acceleration, wanted, length)/bound(2)
   end function apart

   !> The largest of `x` (3, links) with lengths in units of `length`.
   real(wp) function largest(x, wanted, length)
      real(wp), intent(in) :: x(:, :), length
      logical, intent(in) :: wanted(:)

      largest = max(maxval(maxval(abs(x(:2, :)), 1), mask=wanted)/length, maxval(abs(x(3, :)), mask=wanted))
   end function largest
end module compare_engines
