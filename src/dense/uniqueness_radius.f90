!> How far the next root of the closure equations is from a position found: what the steps along a curve of assemblies
!> rely on (card CIRCUITS).
!>
!> Newton and Kantorovich, row by row. Two positions z and z + d with the same values of the drives have J d = -R, with
!> J the Jacobian at z and R_k the part of row k beyond its linear one, at most L_k |d|^2/2. Rows of angles alone are
!> linear: R is 0 there, and links that a prismatic pair ties together turn by the same angle. So
!>    revolute pair        L = |u| + |w|      body vectors of links that turn
!>    X, Y drive           L = |u|
!>    (9), SLIDE drive     L = 2 W + |x_i - x_j|, if the guide turns, otherwise 0
!> and |d| needs to hold only what these depend on: angles, and (x_i - x_j)/W of prismatic pairs whose guide turns. For
!> each such coordinate g . d is at most |d|^2/2 times the sum over k of |g . J^-1 e_k| L_k; the largest of these sums,
!> K, leaves no other root within 2/K. Rejected: |J^-1| times the largest L, which is larger by 10 to 1000, since places
!> and given angles count in it too.
!>
!> Along one direction t J^-1 J changes by D a unit of length: D is the largest of the sums over the coordinates e_m of
!> |g . J^-1 J'[t] e_m|. Forces at the joints of one link cancel in it: D is K |t| at most, and often a tenth of it.
!>
!> W is |x_i - x_j| where that is above 1: then K does not grow as a slide goes to infinity.
module uniqueness_radius
   use kinds, only: wp
   use mechanism, only: has_guide, drive_x, drive_y, drive_slide
   use disjoint_sets, only: joined
   use lapack, only: getrs
   use linear_solver, only: factors_t
   use configuration, only: system_t, configuration_t
   use closure_equations, only: remainder
   implicit none
   private
   public :: coordinates_t, new_coordinates, measure_slides, distance, forms_by_inverse, jacobian_lipschitz, &
      kantorovich, change_along

   !> The coordinates in which the rows of a system are not linear.
   type :: coordinates_t
      integer :: angles = 0
      integer, allocatable :: angle_of(:)      !< (links) the number of its angle; 0: it does not turn
      integer, allocatable :: slides(:)        !< the prismatic pairs whose guide turns
      !> (n, angles + 2 slides) Linear forms in the unknowns: of each angle one; of each slide two, its x and y.
      real(wp), allocatable :: forms(:, :)
   end type coordinates_t

contains

   !> Finds the coordinates of `s`, of its slides for the time being in units of length.
   function new_coordinates(s) result(c)
      type(system_t), intent(in) :: s
      type(coordinates_t) :: c
      logical :: is_guided(size(s%pairs))
      integer :: group(size(s%column)), link_i(size(s%pairs)), link_j(size(s%pairs)), link, k

      link_i = s%link_of(s%pairs%point_i)
      link_j = s%link_of(s%pairs%point_j)
      is_guided = has_guide(s%pairs%kind)
      group = joined(spread(.true., 1, size(group)), pack(link_i, is_guided), pack(link_j, is_guided))

      allocate (c%angle_of(size(group)), source=0)
      do link = 1, size(group)
         if (any(group == group(link) .and. s%column == 0)) cycle
         k = findloc(group, group(link), dim=1)
         if (k == link) c%angles = c%angles + 1
         c%angle_of(link) = merge(c%angles, c%angle_of(k), k == link)
      end do
      c%slides = pack([(k, k=1, size(link_i))], is_guided .and. c%angle_of(link_i) > 0)

      allocate (c%forms(s%n, c%angles + 2*size(c%slides)), source=0.0_wp)
      do k = 1, c%angles
         c%forms(s%column(findloc(c%angle_of, k, dim=1)) + 2, k) = 1.0_wp
      end do
   end function new_coordinates

   !> Measures the slides of `c` in their unit W at configuration `p`.
   pure subroutine measure_slides(s, p, c)
      type(system_t), intent(in) :: s
      type(configuration_t), intent(in) :: p
      type(coordinates_t), intent(inout) :: c
      integer :: k, axis

      do k = 1, size(c%slides)
         associate (pair => s%pairs(c%slides(k)))
            associate (i => s%column(s%link_of(pair%point_i)), j => s%column(s%link_of(pair%point_j)))
               do axis = 1, 2
                  associate (form => c%forms(:, c%angles + 2*k - 2 + axis))
                     form(i + axis - 1) = 1.0_wp/max(1.0_wp, slide_length(s, p, c%slides(k)))
                     if (j > 0) form(j + axis - 1) = -form(i + axis - 1)
                  end associate
               end do
            end associate
         end associate
      end do
   end subroutine measure_slides

   !> |x_i - x_j| of pair number `k` at configuration `p`.
   pure real(wp) function slide_length(s, p, k)
      type(system_t), intent(in) :: s
      type(configuration_t), intent(in) :: p
      integer, intent(in) :: k

      slide_length = norm2(p%q(:2, s%link_of(s%pairs(k)%point_i)) - p%q(:2, s%link_of(s%pairs(k)%point_j)))
   end function slide_length

   !> The largest coordinate of the difference `d` (n) of two positions.
   pure real(wp) function distance(c, d)
      type(coordinates_t), intent(in) :: c
      real(wp), intent(in) :: d(:)

      distance = largest(c, abs(matmul(d, c%forms)))
   end function distance

   !> The largest coordinate where its forms are `x`, none negative; those of a slide are one vector.
   pure real(wp) function largest(c, x)
      type(coordinates_t), intent(in) :: c
      real(wp), intent(in) :: x(:)             !< (forms)

      largest = maxval([0.0_wp, x(:c%angles), hypot(x(c%angles + 1::2), x(c%angles + 2::2))])
   end function largest

   !> (n, forms + 1) The forms of `c` times the inverse of the matrix with the factors `f`, in whose place of the last
   !> row stands the `tangent`, on which the other rows are 0. If `tangent` is 0 the matrix is as it is.
   function forms_by_inverse(c, f, tangent) result(y)
      type(coordinates_t), intent(in) :: c
      type(factors_t), intent(in) :: f
      real(wp), intent(in) :: tangent(:)       !< (n) unit vector, or 0
      real(wp) :: y(size(c%forms, 1), size(c%forms, 2) + 1)
      integer :: k, info

      associate (last => size(y, 2))
         y(:, :last - 1) = c%forms
         y(:, last) = tangent
         call getrs('T', f%n, last, f%a, f%n, f%pivots, y, f%n, info)
         do k = 1, last - 1
            y(:, k) = y(:, k) - dot_product(c%forms(:, k), tangent)*y(:, last)
         end do
      end associate
   end function forms_by_inverse

   !> Bounds (rows) of what the rows hold beyond their linear part at configuration `p`: L_k of above. The two rows of
   !> a revolute pair have one bound, that of their vector.
   pure function jacobian_lipschitz(s, c, p) result(bound)
      type(system_t), intent(in) :: s
      type(coordinates_t), intent(in) :: c
      type(configuration_t), intent(in) :: p
      real(wp) :: bound(2*size(s%pairs) + size(s%drives))
      real(wp) :: body(size(s%link_of))
      integer :: k, row

      ! The length of the body vector of each point; 0 where the link does not turn.
      body = merge(norm2(s%offset, dim=1), 0.0_wp, c%angle_of(s%link_of) > 0)
      bound = 0.0_wp
      do k = 1, size(s%pairs)
         associate (i => s%pairs(k)%point_i, j => s%pairs(k)%point_j, slide => slide_length(s, p, k))
            if (.not. has_guide(s%pairs(k)%kind)) then
               bound(2*k - 1:2*k) = body(i) + body(j)
            else if (c%angle_of(s%link_of(i)) > 0) then
               bound(2*k - 1) = 2.0_wp*max(1.0_wp, slide) + slide
            end if
         end associate
      end do
      do k = 1, size(s%drives)
         row = 2*size(s%pairs) + k
         associate (subject => s%drives(k)%subject)
            if (any(s%drives(k)%kind == [drive_x, drive_y])) bound(row) = body(subject)
            if (s%drives(k)%kind == drive_slide) bound(row) = bound(2*subject - 1)
         end associate
      end do
   end function jacobian_lipschitz

   !> K at configuration `p`: no other root is within 2/K, by `distance`. `y`: the forms of `c` times the inverse of a
   !> matrix whose first rows are those of the system; its others are linear.
   pure real(wp) function kantorovich(s, c, y, p) result(k)
      type(system_t), intent(in) :: s
      type(coordinates_t), intent(in) :: c
      type(configuration_t), intent(in) :: p
      real(wp), intent(in) :: y(:, :)          !< (n, forms or more)
      real(wp) :: bound(2*size(s%pairs) + size(s%drives))
      integer :: m

      bound = jacobian_lipschitz(s, c, p)
      k = largest(c, [(row_sum(y(:, m)), m=1, size(c%forms, 2))])

   contains

      !> The sum over the rows of |g . J^-1 e_k| L_k for one form, `x` = g . J^-1; the two of a pair as one vector.
      pure real(wp) function row_sum(x) result(total)
         real(wp), intent(in) :: x(:)

         associate (pairs => 2*size(s%pairs), each => x(:size(bound))*bound)
            total = sum(hypot(each(1:pairs:2), each(2:pairs:2))) + sum(abs(each(pairs + 1:)))
         end associate
      end function row_sum
   end function kantorovich

   !> D at configuration `p` in the direction `along`; `y` as of `kantorovich`.
   pure real(wp) function change_along(s, c, y, p, along) result(change)
      type(system_t), intent(in) :: s
      type(coordinates_t), intent(in) :: c
      real(wp), intent(in) :: y(:, :)          !< (n, forms or more)
      type(configuration_t), intent(in) :: p
      real(wp), intent(in) :: along(:, :)      !< (3, links)
      real(wp) :: total(size(c%forms, 2)), part(size(c%forms, 2), 2), unit(3, size(along, 2))
      logical :: is_of_pair(size(y, 1))
      integer :: k, axis

      total = 0.0_wp
      do k = 1, c%angles
         unit = 0.0_wp
         where (c%angle_of == k) unit(3, :) = 1.0_wp
         total = total + abs(matmul(mixed_derivative(), y(:, :size(total))))
      end do
      do k = 1, size(c%slides)
         associate (pair => c%slides(k))
            is_of_pair = .false.
            is_of_pair(2*pair - 1) = .true.
            is_of_pair(2*size(s%pairs) + 1:2*size(s%pairs) + size(s%drives)) = &
               s%drives%kind == drive_slide .and. s%drives%subject == pair
            do axis = 1, 2
               unit = 0.0_wp
               unit(axis, s%link_of(s%pairs(pair)%point_i)) = max(1.0_wp, slide_length(s, p, pair))
               ! The link may have other slides.
               part(:, axis) = matmul(merge(mixed_derivative(), 0.0_wp, is_of_pair), y(:, :size(total)))
            end do
         end associate
         total = total + hypot(part(:, 1), part(:, 2))
      end do
      change = largest(c, total)

   contains

      !> (n) The rows' second derivative by `along` and by `unit`.
      pure function mixed_derivative() result(rows)
         real(wp) :: rows(size(y, 1)), less(size(y, 1))

         call remainder(s, p, along + unit, rows)
         call remainder(s, p, along - unit, less)
         rows = 0.25_wp*(rows - less)
      end function mixed_derivative
   end function change_along
end module uniqueness_radius
