!> How far the next root of the closure equations is from a position found: what the steps along a curve of assemblies
!> rely on (card CIRCUITS).
!>
!> Newton and Kantorovich, row by row. Two positions z and z + d with the same values of the drives have J d = -R, with
!> J the Jacobian at z and R_k the part of row k beyond its linear one, at most L_k |d|^2/2. Rows of angles alone are
!> linear: R is 0 there, and links that a prismatic pair ties together turn by the same angle. So
!>    revolute pair        L = |u| + |w|      body vectors of links that move
!>    X, Y drive           L = |u|
!>    (9), SLIDE drive     L = 2 + |x_i - x_j|, if the guide moves, otherwise 0
!> and |d| needs to hold only what these depend on: angles, and x_i - x_j of prismatic pairs whose guide moves. For
!> each such coordinate g . d is at most |d|^2/2 times the sum over k of |g . J^-1 e_k| L_k; the largest of these sums,
!> K, leaves no other root within 2/K. Rejected: |J^-1| times the largest L, which is larger by 10 to 1000, since places
!> and given angles count in it too.
!>
!> A coordinate x_i - x_j may be measured in a unit of its own, W: then L = 2 W + |x_i - x_j|, and its sum is divided by
!> W. With a unit of the order of a long slide, K does not grow as the slide goes to infinity.
module root_distance
   use kinds, only: wp
   use mechanism, only: pair_revolute, pair_prismatic, drive_x, drive_y, drive_slide
   use lapack, only: getrs
   use linear_solver, only: factors_t
   use pose, only: system_t, pose_t
   implicit none
   private
   public :: coordinates_t, new_coordinates, jacobian_lipschitz, kantorovich, distance

   !> What the rows are not linear in.
   type :: coordinates_t
      integer, allocatable :: angles(:)          !< the links that move
      integer, allocatable :: slots(:)           !< prismatic pairs whose guide does
      real(wp), allocatable :: unit(:)           !< (pairs) W, in the unit of length
   end type coordinates_t

contains

   !> The coordinates of the system `s`.
   pure function new_coordinates(s) result(c)
      type(system_t), intent(in) :: s
      type(coordinates_t) :: c
      integer :: i

      c%angles = pack([(i, i=1, size(s%column))], s%column > 0)
      c%slots = pack([(i, i=1, size(s%pairs))], &
         s%pairs%kind == pair_prismatic .and. s%column(s%link_of(s%pairs%point_i)) > 0)
      allocate (c%unit(size(s%pairs)), source=1.0_wp)
   end function new_coordinates

   !> The largest change, in rad and units of the slots, of these coordinates between the positions `a` and `b`
   !> (3, links).
   pure real(wp) function distance(s, c, a, b)
      type(system_t), intent(in) :: s
      type(coordinates_t), intent(in) :: c
      real(wp), intent(in) :: a(:, :), b(:, :)
      integer :: k

      distance = maxval([0.0_wp, abs(a(3, c%angles) - b(3, c%angles))])
      do k = 1, size(c%slots)
         associate (i => s%link_of(s%pairs(c%slots(k))%point_i), j => s%link_of(s%pairs(c%slots(k))%point_j))
            distance = max(distance, norm2((a(:2, i) - a(:2, j)) - (b(:2, i) - b(:2, j)))/c%unit(c%slots(k)))
         end associate
      end do
   end function distance

   !> Bounds (rows) of what the rows hold beyond their linear part at pose `p`: L_k of above. The two rows of a revolute
   !> pair have one bound, that of their vector.
   pure function jacobian_lipschitz(s, c, p) result(bound)
      type(system_t), intent(in) :: s
      type(coordinates_t), intent(in) :: c
      type(pose_t), intent(in) :: p
      real(wp) :: bound(2*size(s%pairs) + size(s%laws))
      real(wp) :: body(size(s%link_of))
      integer :: k, row

      ! The length of the body vector of each point; 0 where the link does not move.
      body = merge(norm2(s%offset, dim=1), 0.0_wp, s%column(s%link_of) > 0)
      bound = 0.0_wp
      do k = 1, size(s%pairs)
         associate (i => s%pairs(k)%point_i, j => s%pairs(k)%point_j)
            if (s%pairs(k)%kind == pair_revolute) then
               bound(2*k - 1:2*k) = body(i) + body(j)
            else if (s%column(s%link_of(i)) > 0) then
               bound(2*k - 1) = 2.0_wp*c%unit(k) + norm2(p%q(:2, s%link_of(i)) - p%q(:2, s%link_of(j)))
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

   !> K at pose `p`, from the factors `f` of the Jacobian there: no other root is within 2/K, by `distance`. The first
   !> rows of the matrix are those of the system; its others are linear. From now on `c` measures x_i - x_j of each
   !> prismatic pair in its length at `p`, where that is above 1.
   subroutine kantorovich(s, c, f, p, k)
      type(system_t), intent(in) :: s
      type(coordinates_t), intent(inout) :: c
      type(factors_t), intent(in) :: f
      type(pose_t), intent(in) :: p
      real(wp), intent(out) :: k
      real(wp) :: g(s%n, size(c%angles) + 2*size(c%slots)), bound(2*size(s%pairs) + size(s%laws))
      integer :: m, axis, info

      k = 0.0_wp
      if (size(g) == 0) return
      ! The coordinates as columns: each is g . x.
      g = 0.0_wp
      do m = 1, size(c%angles)
         g(s%column(c%angles(m)) + 2, m) = 1.0_wp
      end do
      do m = 1, size(c%slots)
         associate (pair => s%pairs(c%slots(m)))
            c%unit(c%slots(m)) = max(1.0_wp, norm2(p%q(:2, s%link_of(pair%point_i)) - p%q(:2, s%link_of(pair%point_j))))
         end associate
         associate (i => s%column(s%link_of(s%pairs(c%slots(m))%point_i)), &
                    j => s%column(s%link_of(s%pairs(c%slots(m))%point_j)))
            do axis = 0, 1
               if (i > 0) g(i + axis, size(c%angles) + 2*m - 1 + axis) = 1.0_wp
               if (j > 0) g(j + axis, size(c%angles) + 2*m - 1 + axis) = -1.0_wp
            end do
         end associate
      end do
      call getrs('T', f%n, size(g, 2), f%a, f%n, f%pivots, g, f%n, info)

      bound = jacobian_lipschitz(s, c, p)
      do m = 1, size(c%angles)
         k = max(k, row_sum(m))
      end do
      do m = 1, size(c%slots)
         associate (last => size(c%angles) + 2*m)
            k = max(k, hypot(row_sum(last - 1), row_sum(last))/c%unit(c%slots(m)))
         end associate
      end do

   contains

      !> The sum over the rows of |g . J^-1 e_k| L_k for column `m` of g, the two of a pair as one vector.
      pure real(wp) function row_sum(m) result(total)
         integer, intent(in) :: m

         associate (pairs => 2*size(s%pairs), y => g(:size(bound), m)*bound)
            total = sum(hypot(y(1:pairs:2), y(2:pairs:2))) + sum(abs(y(pairs + 1:)))
         end associate
      end function row_sum
   end subroutine kantorovich
end module root_distance
