!> How far the next root of the closure equations is from a position found: what the steps along a curve of assemblies
!> rely on (card CIRCUITS).
!>
!> Newton and Kantorovich, row by row. Two positions z and z + d with the same values of the drives have J d = -R, with
!> J the Jacobian at z and R_k the part of row k beyond its linear one, at most L_k |d|^2/2. Rows of angles alone are
!> linear: R is 0 there, and links that a prismatic pair ties together turn by the same angle. So
!>    revolute pair        L = |u| + |w|      body vectors of links that move
!>    X, Y drive           L = |u|
!>    (9), SLIDE drive     L = 2 W + |x_i - x_j|, if the guide moves, otherwise 0
!> and |d| needs to hold only what these depend on: angles, and (x_i - x_j)/W of prismatic pairs whose guide moves. For
!> each such coordinate g . d is at most |d|^2/2 times the sum over k of |g . J^-1 e_k| L_k; the largest of these sums,
!> K, leaves no other root within 2/K. Rejected: |J^-1| times the largest L, which is larger by 10 to 1000, since places
!> and given angles count in it too.
!>
!> W is |x_i - x_j| where that is above 1: then K does not grow as a slide goes to infinity.
module root_distance
   use kinds, only: wp
   use mechanism, only: pair_revolute, pair_prismatic, drive_x, drive_y, drive_slide
   use lapack, only: getrs
   use linear_solver, only: factors_t
   use pose, only: system_t, pose_t
   implicit none
   private
   public :: coordinates_at, jacobian_lipschitz, kantorovich, distance

contains

   !> (n, 2, any number) What the rows of `s` are not linear in at pose `p`, each two linear forms in the unknowns: an
   !> angle and 0, x and y of a slide whose guide moves.
   pure function coordinates_at(s, p) result(g)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      real(wp), allocatable :: g(:, :, :)
      integer :: k, m, axis

      associate (guide_column => s%column(s%link_of(s%pairs%point_i)))
         allocate (g(s%n, 2, count(s%column > 0) + count(s%pairs%kind == pair_prismatic .and. guide_column > 0)), &
            source=0.0_wp)
      end associate
      m = 0
      do k = 1, size(s%column)
         if (s%column(k) == 0) cycle
         m = m + 1
         g(s%column(k) + 2, 1, m) = 1.0_wp
      end do
      do k = 1, size(s%pairs)
         associate (i => s%column(s%link_of(s%pairs(k)%point_i)), j => s%column(s%link_of(s%pairs(k)%point_j)))
            if (s%pairs(k)%kind /= pair_prismatic .or. i == 0) cycle
            m = m + 1
            do axis = 1, 2
               g(i + axis - 1, axis, m) = 1.0_wp/max(1.0_wp, slide_length(s, p, k))
               if (j > 0) g(j + axis - 1, axis, m) = -g(i + axis - 1, axis, m)
            end do
         end associate
      end do
   end function coordinates_at

   !> |x_i - x_j| of pair number `k` at pose `p`.
   pure real(wp) function slide_length(s, p, k)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      integer, intent(in) :: k

      slide_length = norm2(p%q(:2, s%link_of(s%pairs(k)%point_i)) - p%q(:2, s%link_of(s%pairs(k)%point_j)))
   end function slide_length

   !> The largest of the coordinates `g` of the difference `d` (n) of two positions.
   pure real(wp) function distance(g, d)
      real(wp), intent(in) :: g(:, :, :), d(:)
      integer :: m

      distance = maxval([0.0_wp, (norm2(matmul(d, g(:, :, m))), m=1, size(g, 3))])
   end function distance

   !> Bounds (rows) of what the rows hold beyond their linear part at pose `p`: L_k of above. The two rows of a revolute
   !> pair have one bound, that of their vector.
   pure function jacobian_lipschitz(s, p) result(bound)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      real(wp) :: bound(2*size(s%pairs) + size(s%laws))
      real(wp) :: body(size(s%link_of))
      integer :: k, row

      ! The length of the body vector of each point; 0 where the link does not move.
      body = merge(norm2(s%offset, dim=1), 0.0_wp, s%column(s%link_of) > 0)
      bound = 0.0_wp
      do k = 1, size(s%pairs)
         associate (i => s%pairs(k)%point_i, j => s%pairs(k)%point_j, slide => slide_length(s, p, k))
            if (s%pairs(k)%kind == pair_revolute) then
               bound(2*k - 1:2*k) = body(i) + body(j)
            else if (s%column(s%link_of(i)) > 0) then
               bound(2*k - 1) = 2.0_wp*max(1.0_wp, slide) + slide
            end if
         end associate
      end do
      do k = 1, size(s%laws)
         row = 2*size(s%pairs) + k
         associate (subject => s%laws(k)%subject)
            if (any(s%laws(k)%kind == [drive_x, drive_y])) bound(row) = body(subject)
            if (s%laws(k)%kind == drive_slide) bound(row) = bound(2*subject - 1)
         end associate
      end do
   end function jacobian_lipschitz

   !> K at pose `p`, from the factors `f` of the Jacobian there: no other root is within 2/K, by `distance` in the
   !> coordinates `g`. The first rows of the matrix are those of the system; its others are linear.
   real(wp) function kantorovich(s, g, f, p) result(k)
      type(system_t), intent(in) :: s
      real(wp), intent(in) :: g(:, :, :)
      type(factors_t), intent(in) :: f
      type(pose_t), intent(in) :: p
      real(wp) :: y(size(g, 1), size(g, 2), size(g, 3)), bound(2*size(s%pairs) + size(s%laws))
      integer :: m, info

      y = g
      call getrs('T', f%n, 2*size(g, 3), f%a, f%n, f%pivots, y, f%n, info)
      bound = jacobian_lipschitz(s, p)
      k = maxval([0.0_wp, (hypot(row_sum(y(:, 1, m)), row_sum(y(:, 2, m))), m=1, size(g, 3))])

   contains

      !> The sum over the rows of |g . J^-1 e_k| L_k for one form, `x` = g . J^-1; the two of a pair as one vector.
      pure real(wp) function row_sum(x) result(total)
         real(wp), intent(in) :: x(:)

         associate (pairs => 2*size(s%pairs), each => x(:size(bound))*bound)
            total = sum(hypot(each(1:pairs:2), each(2:pairs:2))) + sum(abs(each(pairs + 1:)))
         end associate
      end function row_sum
   end function kantorovich
end module root_distance
