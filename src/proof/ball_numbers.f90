!> The geometry of the blocks in balls. A radius bounds the roundings of sums and of the deck's decimals.
!>
!> The exact mechanism is any mechanism whose numbers differ from those of `mechanism_t` by at most four roundings each:
!> the mechanism of the deck's decimals is one of these. Splines of tables are exact as they are computed. A vector that
!> is zero in the structure (its terms cancel but for rounding) is zero. Sines and cosines of the library are taken to
!> be right within two units in the last place; all other operations round to nearest.
module ball_numbers
   use kinds, only: wp
   use plane_vectors, only: length_of, real_vector_t => vector_t
   use mechanism, only: mechanism_t, has_guide, plane_origin
   use blocks, only: blocks_t, geometry_t, loop_angles
   use balls, only: ball_t, rounding, room
   use ball_equations, only: vector_t, ball_numbers_t
   implicit none
   private
   public :: new_ball_numbers

   !> Relative error of a number of the deck: the roundings of its decimals and units.
   real(wp), parameter, public :: number_error = 4.0_wp*rounding
   !> Relative error of the components of a vector that the deck's angles turn: sine and cosine, products and their sum.
   real(wp), parameter :: vector_error = 8.0_wp*rounding

contains

   !> Makes the geometry of a mechanism in balls, about its geometry in reals.
   function new_ball_numbers(m, b, x) result(p)
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(in) :: b        !< of `m`, solvable
      type(geometry_t), intent(in) :: x      !< of `m`, with its chain
      type(ball_numbers_t) :: p
      real(wp) :: angle, of_direction, of_vectors, lengths(0:b%tree%orientations)
      integer :: i, k

      angle = angle_error(m)
      of_direction = 2.0_wp*vector_error + angle

      allocate (p%rows(size(b%rows)), p%loops(size(b%loops)), p%d(size(b%body_vectors)), p%e(size(b%slides)))
      do i = 1, size(b%loops)
         associate (g => b%loops(i), own => x%loops(i), v => b%equations%vector_loops)
            if (g%kind == loop_angles) cycle
            ! (0:orientations) The length of all vectors of the loop that turn with the orientation, in the deck's unit.
            lengths = 0.0_wp
            do k = v%first_term(g%vector_loop), v%first_term(g%vector_loop + 1) - 1
               associate (l => lengths(v%vector_orientation(v%term_vector(k))), term => abs(v%terms(:, k)))
                  if (term(1) > 0) l = l + length_in_link(m, term(1))
                  if (term(2) > 0) l = l + abs(m%pairs(term(2))%offset)
               end associate
            end do
            associate (terms => v%first_term(g%vector_loop + 1) - v%first_term(g%vector_loop))
               lengths = lengths*(number_error + vector_error + angle + terms*rounding) &
                  /(x%equations%length*own%unit)*room
            end associate

            p%loops(i)%ground = around(own%ground, lengths(0))
            p%loops(i)%direction = around(own%direction, of_direction*length_of(own%direction))
            do k = g%first_vector, g%last_vector
               p%d(k) = around(x%d(k), lengths(b%body_vectors(k)%orientation))
            end do
            do k = g%first_slide, g%last_slide
               p%e(k) = around(x%e(k), of_direction*length_of(x%e(k)))
            end do
         end associate
      end do

      of_vectors = (number_error + of_direction)*(maxval([0.0_wp, length_in_link(m, [(i, i=1, size(m%points))])]) &
         + maxval([0.0_wp, abs(m%pairs%offset)]))
      allocate (p%links(x%chain%wanted))
      do i = 1, x%chain%wanted
         associate (own => x%chain%links(i)%numbers)
            p%links(i)%offset = around(own%offset, of_vectors)
            p%links(i)%body_vector = around(own%body_vector, of_vectors)
            p%links(i)%slide_vector = around(own%slide_vector, of_direction*length_of(own%slide_vector))
            p%links(i)%root_unit = around(own%root_unit, 0.0_wp)
            p%links(i)%angle_offset = ball_t(own%angle_offset, angle)
         end associate
      end do

      p%rows%constant%mid = x%rows%constant
      p%rows%constant%radius = (2.0_wp*number_error*abs(x%rows%constant) &
         + merge(2.0_wp*angle, 0.0_wp, b%rows%angular))*room
   end function new_ball_numbers

   !> Makes a vector in balls: about each component of a vector, with one radius.
   elemental type(vector_t) function around(vector, radius)
      type(real_vector_t), intent(in) :: vector   !< the midpoints
      real(wp), intent(in) :: radius         !< in the unit of the vector

      around = vector_t(ball_t(vector%x, radius*room), ball_t(vector%y, radius*room))
   end function around

   !> Bounds the errors, in rad, of all directions of guides and of all angles of links from their orientations. Such
   !> an angle is a sum of angles of the deck, and the bound takes all angles on cards that can be in such a sum.
   pure real(wp) function angle_error(m) result(angle)
      type(mechanism_t), intent(in) :: m

      associate (guides => has_guide(m%pairs%kind))
         angle = (number_error + (1 + count(guides))*rounding)*(sum(abs(m%pairs%beta) + abs(m%pairs%alpha), guides) &
            + maxval([0.0_wp, abs(m%links%position(3))], [.true., m%links%ground]))
      end associate
   end function angle_error

   !> Bounds the length of the vector to a point from the origin of its link, in the deck's unit. To a point of the
   !> ground the vectors from the deck's origin and to the origin of positions are added.
   elemental real(wp) function length_in_link(m, i) result(length)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i               !< number of the point

      associate (link => m%links(m%points(i)%link))
         length = norm2(m%points(i)%offset)
         if (link%ground) length = length + norm2(link%position(:2)) + norm2(plane_origin(m))
      end associate
   end function length_in_link
end module ball_numbers
