!> How far the next root of the closure equations is from a position: the steps along a curve of assemblies rely on it
!> (card CIRCUITS).
!>
!> The theorem of Newton and Kantorovich, row by row. Two positions z and z + d with equal values of the drives have
!> J d = -R, with J the Jacobian at z and R_k the part of row k beyond its linear part, at most L_k |d|^2/2. Rows of
!> angles only are linear: their R is 0, and links that prismatic pairs join turn by one angle. The bounds are
!>    revolute pair        L = |u| + |w|      body vectors of links that turn
!>    X, Y drive           L = |u|
!>    (9), SLIDE drive     L = 2 W + |x_i - x_j|, if the guide turns, otherwise 0
!> and |d| needs to hold only the coordinates on which these rows depend: angles, and (x_i - x_j)/W of prismatic pairs
!> whose guide turns. For each such coordinate g, g . d is at most |d|^2/2 times the sum over k of |g . J^-1 e_k| L_k.
!> The largest of these sums, K, leaves no other root within 2/K. Rejected: |J^-1| times the largest L, which is larger
!> by 10 to 1000, since positions and given angles count in it too.
!>
!> Along one direction t, J^-1 J changes by D a unit of length: D is the largest of the sums over the coordinates e_m of
!> |g . J^-1 J'[t] e_m|. Forces at the joints of one link cancel in D: it is K |t| at most, and often a tenth of that.
!>
!> W is the larger of |x_i - x_j| and 1, in the system's unit of length: K does not grow as a slide goes to infinity.
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
      integer :: angles = 0                    !< how many angles there are
      integer, allocatable :: angle_of(:)      !< (links) the number of its angle; 0: the link does not turn
      integer, allocatable :: slides(:)        !< numbers of the prismatic pairs whose guide turns
      !> (n, angles + 2 slides) Linear forms in the unknowns: of each angle one; of each slide two, its x and y.
      real(wp), allocatable :: forms(:, :)
   end type coordinates_t

contains

   !> Finds the coordinates of a system. The forms of slides are 0 until `measure_slides`.
   function new_coordinates(system) result(c)
      type(system_t), intent(in) :: system   !< the closure equations
      type(coordinates_t) :: c
      logical :: is_guided(size(system%pairs))
      integer :: group(size(system%column)), link_i(size(system%pairs)), link_j(size(system%pairs)), link, k

      link_i = system%link_of(system%pairs%point_i)
      link_j = system%link_of(system%pairs%point_j)
      is_guided = has_guide(system%pairs%kind)
      group = joined(spread(.true., 1, size(group)), pack(link_i, is_guided), pack(link_j, is_guided))

      allocate (c%angle_of(size(group)), source=0)
      do link = 1, size(group)
         if (any(group == group(link) .and. system%column == 0)) cycle
         k = findloc(group, group(link), dim=1)
         if (k == link) c%angles = c%angles + 1
         c%angle_of(link) = merge(c%angles, c%angle_of(k), k == link)
      end do
      c%slides = pack([(k, k=1, size(link_i))], is_guided .and. c%angle_of(link_i) > 0)

      allocate (c%forms(system%n, c%angles + 2*size(c%slides)), source=0.0_wp)
      do k = 1, c%angles
         c%forms(system%column(findloc(c%angle_of, k, dim=1)) + 2, k) = 1.0_wp
      end do
   end function new_coordinates

   !> Sets the forms of the slides of coordinates, in their units W at a configuration.
   pure subroutine measure_slides(system, configuration, coordinates)
      type(system_t), intent(in) :: system   !< the closure equations
      type(configuration_t), intent(in) :: configuration   !< of the system
      type(coordinates_t), intent(inout) :: coordinates   !< of the system
      integer :: k, axis

      do k = 1, size(coordinates%slides)
         associate (pair => system%pairs(coordinates%slides(k)))
            associate (i => system%column(system%link_of(pair%point_i)), &
               j => system%column(system%link_of(pair%point_j)))
               do axis = 1, 2
                  associate (form => coordinates%forms(:, coordinates%angles + 2*k - 2 + axis))
                     form(i + axis - 1) = 1.0_wp/max(1.0_wp, slide_length(system, configuration, coordinates%slides(k)))
                     if (j > 0) form(j + axis - 1) = -form(i + axis - 1)
                  end associate
               end do
            end associate
         end associate
      end do
   end subroutine measure_slides

   !> Gives the distance |x_i - x_j| of the origins of a pair's links at a configuration, in the system's unit of
   !> length.
   pure real(wp) function slide_length(system, configuration, k)
      type(system_t), intent(in) :: system   !< the closure equations
      type(configuration_t), intent(in) :: configuration   !< of the system
      integer, intent(in) :: k   !< the number of the pair

      slide_length = norm2(configuration%q(:2, system%link_of(system%pairs(k)%point_i)) &
         - configuration%q(:2, system%link_of(system%pairs(k)%point_j)))
   end function slide_length

   !> Gives the largest coordinate of the difference of two positions, in rad or in units W.
   pure real(wp) function distance(coordinates, change)
      type(coordinates_t), intent(in) :: coordinates   !< with measured slides
      real(wp), intent(in) :: change(:)   !< (n) in the system's unit of length and rad

      distance = largest(coordinates, abs(matmul(change, coordinates%forms)))
   end function distance

   !> Gives the largest coordinate from the values of the forms; the two forms of a slide are one vector. 0 without
   !> forms.
   pure real(wp) function largest(coordinates, values)
      type(coordinates_t), intent(in) :: coordinates   !< of the system
      real(wp), intent(in) :: values(:)      !< (forms) 0 or more, in rad or in units W

      largest = maxval([0.0_wp, values(:coordinates%angles), hypot(values(coordinates%angles + 1::2), &
         values(coordinates%angles + 2::2))])
   end function largest

   !> Multiplies the forms by the inverse of a factored matrix: columns g . J^-1 (n, forms + 1), of which the last is
   !> scratch. If `tangent` is not 0, it is the last row of the matrix, and the other rows are 0 on it: then the forms
   !> count only across the tangent.
   function forms_by_inverse(coordinates, factors, tangent) result(y)
      type(coordinates_t), intent(in) :: coordinates   !< with measured slides
      type(factors_t), intent(in) :: factors   !< of the matrix
      real(wp), intent(in) :: tangent(:)       !< (n) unit vector, or 0
      real(wp) :: y(size(coordinates%forms, 1), size(coordinates%forms, 2) + 1)
      integer :: k, info

      associate (last => size(y, 2))
         y(:, :last - 1) = coordinates%forms
         y(:, last) = tangent
         call getrs('T', factors%n, last, factors%a, factors%n, factors%pivots, y, factors%n, info)
         do k = 1, last - 1
            y(:, k) = y(:, k) - dot_product(coordinates%forms(:, k), tangent)*y(:, last)
         end do
      end associate
   end function forms_by_inverse

   !> Bounds the part of the rows (rows of pairs, then of drives) beyond their linear part at a configuration: L_k of
   !> the module's head, in the system's unit of length. The two rows of a revolute pair have one bound, for their
   !> vector.
   pure function jacobian_lipschitz(system, coordinates, configuration) result(bound)
      type(system_t), intent(in) :: system   !< the closure equations
      type(coordinates_t), intent(in) :: coordinates   !< of the system
      type(configuration_t), intent(in) :: configuration   !< of the system
      real(wp) :: bound(2*size(system%pairs) + size(system%drives))
      real(wp) :: body(size(system%link_of))
      integer :: k, row

      ! The length of the body vector of each point; 0 if the link does not turn.
      body = merge(norm2(system%offset, dim=1), 0.0_wp, coordinates%angle_of(system%link_of) > 0)
      bound = 0.0_wp
      do k = 1, size(system%pairs)
         associate (i => system%pairs(k)%point_i, j => system%pairs(k)%point_j, &
            slide => slide_length(system, configuration, k))
            if (.not. has_guide(system%pairs(k)%kind)) then
               bound(2*k - 1:2*k) = body(i) + body(j)
            else if (coordinates%angle_of(system%link_of(i)) > 0) then
               bound(2*k - 1) = 2.0_wp*max(1.0_wp, slide) + slide
            end if
         end associate
      end do

      do k = 1, size(system%drives)
         row = 2*size(system%pairs) + k
         associate (subject => system%drives(k)%subject)
            if (any(system%drives(k)%kind == [drive_x, drive_y])) bound(row) = body(subject)
            if (system%drives(k)%kind == drive_slide) bound(row) = bound(2*subject - 1)
         end associate
      end do
   end function jacobian_lipschitz

   !> Gives K of the module's head at a configuration: no other root is within 2/K, in the coordinates of `distance`.
   !> The factored matrix has the rows of the system first; any other rows are linear.
   pure real(wp) function kantorovich(system, coordinates, columns, configuration) result(k)
      type(system_t), intent(in) :: system   !< the closure equations
      type(coordinates_t), intent(in) :: coordinates   !< with slides measured at the configuration
      type(configuration_t), intent(in) :: configuration   !< of the system
      real(wp), intent(in) :: columns(:, :)          !< (n, forms or more) g . J^-1, by `forms_by_inverse`
      real(wp) :: bound(2*size(system%pairs) + size(system%drives))
      integer :: m

      bound = jacobian_lipschitz(system, coordinates, configuration)
      k = largest(coordinates, [(row_sum(columns(:, m)), m=1, size(coordinates%forms, 2))])

   contains

      !> Adds up |g . J^-1 e_k| L_k over the rows for one form; the two rows of a pair are one vector.
      pure real(wp) function row_sum(row) result(total)
         real(wp), intent(in) :: row(:)   !< (n) g . J^-1

         associate (pairs => 2*size(system%pairs), each => row(:size(bound))*bound)
            total = sum(hypot(each(1:pairs:2), each(2:pairs:2))) + sum(abs(each(pairs + 1:)))
         end associate
      end function row_sum
   end function kantorovich

   !> Gives the change D of J^-1 J at a configuration along a direction, by the module's head.
   pure real(wp) function change_along(system, coordinates, columns, configuration, along) result(change)
      type(system_t), intent(in) :: system   !< the closure equations
      type(coordinates_t), intent(in) :: coordinates   !< with slides measured at the configuration
      real(wp), intent(in) :: columns(:, :)  !< (n, forms or more) g . J^-1, by `forms_by_inverse`
      type(configuration_t), intent(in) :: configuration   !< of the system
      real(wp), intent(in) :: along(:, :)    !< (3, links) the direction, in the system's unit of length and rad
      real(wp) :: total(size(coordinates%forms, 2)), part(size(coordinates%forms, 2), 2), unit(3, size(along, 2))
      logical :: is_of_pair(size(columns, 1))
      integer :: k, axis

      total = 0.0_wp
      do k = 1, coordinates%angles
         unit = 0.0_wp
         where (coordinates%angle_of == k) unit(3, :) = 1.0_wp
         total = total + abs(matmul(mixed_derivative(), columns(:, :size(total))))
      end do

      do k = 1, size(coordinates%slides)
         associate (pair => coordinates%slides(k))
            is_of_pair = .false.
            is_of_pair(2*pair - 1) = .true.
            is_of_pair(2*size(system%pairs) + 1:2*size(system%pairs) + size(system%drives)) = &
               system%drives%kind == drive_slide .and. system%drives%subject == pair
            do axis = 1, 2
               unit = 0.0_wp
               unit(axis, system%link_of(system%pairs(pair)%point_i)) = max(1.0_wp, &
                  slide_length(system, configuration, pair))
               ! Only the rows of this pair: x and y of the link may be in the rows of other slides.
               part(:, axis) = matmul(merge(mixed_derivative(), 0.0_wp, is_of_pair), columns(:, :size(total)))
            end do
         end associate
         total = total + hypot(part(:, 1), part(:, 2))
      end do
      change = largest(coordinates, total)

   contains

      !> Gives the mixed second derivatives (n) of the rows along `along` and `unit`, from two remainders.
      pure function mixed_derivative() result(rows)
         real(wp) :: rows(size(columns, 1)), less(size(columns, 1))

         call remainder(system, configuration, along + unit, rows)
         call remainder(system, configuration, along - unit, less)
         rows = 0.25_wp*(rows - less)
      end function mixed_derivative
   end function change_along
end module uniqueness_radius
