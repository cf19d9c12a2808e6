!> What the numbers of the cards make of the blocks, in balls. A radius is what the roundings of sums and of the deck's
!> decimals leave open.
!>
!> The exact mechanism is any whose numbers differ from those of `mechanism_t` by at most four roundings each: the
!> deck's decimals are one. Splines of tables count as they are computed. What the structure takes for zero (vectors
!> that cancel but for rounding) is zero. Sines and cosines of the library are taken to be right within two units in the
!> last place; all other operations round to nearest.
module ball_numbers
   use kinds, only: wp
   use planar, only: length_of, real_vector_t => vector_t
   use mechanism, only: mechanism_t, pair_prismatic, plane_origin
   use links_tree, only: tree_t
   use blocks, only: blocks_t, loop_angles
   use balls, only: ball_t, rounding, room
   use ball_equations, only: vector_t, ball_numbers_t
   implicit none
   private
   public :: new_ball_numbers, around, angle_errors, point_error

   !> Of a number of the deck: so many roundings, those of its decimals and units.
   real(wp), parameter, public :: of_number = 4.0_wp*rounding
   !> Of the components of a vector that the deck's angles turn: sine and cosine, products and their sum.
   real(wp), parameter, public :: of_vector = 8.0_wp*rounding

contains

   !> Makes the ball numbers of the blocks `b` of `m`, whose unit of length is `length`.
   function new_ball_numbers(m, b, length) result(x)
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(in) :: b
      real(wp), intent(in) :: length
      type(ball_numbers_t) :: x
      real(wp) :: angle(0:b%tree%orientations), sums(0:b%tree%orientations), of_direction
      integer :: i, k

      angle = angle_errors(m, b%tree)
      of_direction = 2.0_wp*of_vector + maxval(angle)
      allocate (x%rows(size(b%rows)), x%loops(size(b%loops)), x%d(size(b%body_vectors)), x%e(size(b%slides)))
      do i = 1, size(b%loops)
         associate (g => b%loops(i), own => b%numbers%loops(i))
            if (g%kind == loop_angles) cycle
            sums = 0.0_wp
            call add_terms(m, b, g%vector_loop, angle, sums)
            sums = sums/(length*own%unit)*room
            x%loops(i)%ground = around(own%ground, sums(0))
            x%loops(i)%direction = around(own%direction, of_direction*length_of(own%direction))
            do k = g%first_vector, g%last_vector
               x%d(k) = around(b%numbers%d(k), sums(b%body_vectors(k)%orientation))
            end do
            do k = g%first_slide, g%last_slide
               x%e(k) = around(b%numbers%e(k), of_direction*length_of(b%numbers%e(k)))
            end do
         end associate
      end do
      x%rows%constant%mid = b%numbers%rows%constant
      x%rows%constant%radius = (2.0_wp*of_number*abs(b%numbers%rows%constant) &
         + merge(2.0_wp*maxval(angle), 0.0_wp, b%rows%angular))*room
   end function new_ball_numbers

   !> The vector `d`, of which each component is known up to `radius`.
   elemental type(vector_t) function around(d, radius)
      type(real_vector_t), intent(in) :: d
      real(wp), intent(in) :: radius

      around = vector_t(ball_t(d%x, radius*room), ball_t(d%y, radius*room))
   end function around

   !> (0:orientations) Bounds of the errors of the angles of links against their orientations, sums of the deck's; and
   !> of the directions of guides.
   function angle_errors(m, t) result(angle)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      real(wp) :: angle(0:t%orientations)
      integer :: k, joints(0:t%orientations)

      angle = 0.0_wp
      joints = 1
      do k = 1, size(m%links)
         if (m%links(k)%ground) angle(0) = max(angle(0), abs(m%links(k)%position(3)))
      end do
      do k = 1, size(m%pairs)
         if (m%pairs(k)%kind /= pair_prismatic) cycle
         associate (o => t%orientation(m%points(m%pairs(k)%point_i)%link))
            angle(o) = angle(o) + abs(m%pairs(k)%beta) + abs(m%pairs(k)%alpha)
            joints(o) = joints(o) + 1
         end associate
      end do
      angle = (of_number + joints*rounding)*angle
   end function angle_errors

   !> Adds to `sums` (0:orientations) what is open of the terms of vector loop `loop`, in the deck's unit of length.
   !> `angle`: see `angle_errors`.
   subroutine add_terms(m, b, loop, angle, sums)
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: loop
      real(wp), intent(in) :: angle(0:)
      real(wp), intent(inout) :: sums(0:)
      integer :: i, o, count

      associate (p => b%equations%vector_loops, t => b%tree)
         count = p%first_term(loop + 1) - p%first_term(loop)
         do i = p%first_term(loop), p%first_term(loop + 1) - 1
            associate (point => abs(p%terms(1, i)), pair => abs(p%terms(2, i)))
               if (point > 0) then
                  o = t%orientation(m%points(point)%link)
                  sums(o) = sums(o) + point_error(m, point, of_vector + angle(o), count*rounding)
               else
                  o = t%orientation(m%points(m%pairs(pair)%point_i)%link)
                  sums(o) = sums(o) + abs(m%pairs(pair)%offset)*(of_number + of_vector + count*rounding + angle(o))
               end if
            end associate
         end do
      end associate
   end subroutine add_terms

   !> Bounds what is open of the vector to `point` from the origin of its link or, on the ground, from that of the
   !> motion; in the deck's unit of length. `turned`: of its turned part; `summed`: of all its parts, where they are
   !> added up.
   pure real(wp) function point_error(m, point, turned, summed) result(error)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: point
      real(wp), intent(in) :: turned, summed

      associate (link => m%links(m%points(point)%link))
         error = norm2(m%points(point)%offset)*(of_number + turned + summed)
         if (link%ground) error = error + (norm2(link%position(:2)) + norm2(plane_origin(m)))*(of_number + summed)
      end associate
   end function point_error
end module ball_numbers
