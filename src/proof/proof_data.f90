!> How exactly the numbers of the blocks are those of the mechanism: lengths of all vectors, and bounds of what the
!> roundings of their sums, of sines and cosines, and of the deck's decimals make of them.
!>
!> The exact mechanism is any whose numbers differ from those of `mechanism_t` by at most four roundings each: the
!> deck's decimals are one. What the structure takes for zero (vectors that cancel but for rounding) is zero. Sines and
!> cosines of the library are taken to be right within two units in the last place; all other operations round to
!> nearest.
module proof_data
   use kinds, only: wp
   use planar, only: length_of
   use mechanism, only: mechanism_t, pair_prismatic, plane_origin
   use drives, only: law_t
   use links_tree, only: tree_t
   use blocks, only: blocks_t, loop_angles
   implicit none
   private
   public :: proof_data_t, new_proof_data, angle_errors, table_errors, rounding, of_number, of_vector

   !> One rounding error, with room: half of it is the bound of one operation.
   real(wp), parameter :: rounding = epsilon(1.0_wp)
   !> Of a number of the deck: so many roundings, those of its decimals and units.
   real(wp), parameter :: of_number = 4.0_wp*rounding
   !> Of the components of a vector that turns, and of its derivatives: sine and cosine, products and their sum.
   real(wp), parameter :: of_vector = 8.0_wp*rounding
   !> Of a row: its sum with a drive and a constant, and its projection.
   real(wp), parameter :: of_row = 4.0_wp*rounding

   !> Weights bound errors of vectors, in the unit of their loop, as parts of the unit vectors that turn them.
   type :: proof_data_t
      real(wp), allocatable :: length(:), weight(:)                !< (body vectors)
      real(wp), allocatable :: slide_length(:), slide_weight(:)    !< (slides) of their directions
      real(wp), allocatable :: ground_length(:), ground_weight(:)  !< (loops) of what is fixed
      real(wp), allocatable :: direction_length(:), direction_weight(:)   !< (loops) of that on which they are projected
      real(wp), allocatable :: constant_weight(:)                  !< (rows)
   end type proof_data_t

contains

   !> Those of the blocks `b` of `m`, whose unit of length is `length`.
   function new_proof_data(m, b, length) result(d)
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(in) :: b
      real(wp), intent(in) :: length
      type(proof_data_t) :: d
      real(wp), allocatable :: angle(:), sums(:)
      integer :: i, m1, k

      ! A function's result would bring its own lower bound.
      allocate (angle(0:b%tree%orientations))
      angle(:) = angle_errors(m, b%tree)
      allocate (d%length(size(b%body_vectors)), d%weight(size(b%body_vectors)), d%slide_length(size(b%slides)), &
         d%slide_weight(size(b%slides)), d%ground_length(size(b%loops)), d%ground_weight(size(b%loops)), &
         d%direction_length(size(b%loops)), d%direction_weight(size(b%loops)), d%constant_weight(size(b%rows)), &
         source=0.0_wp)
      allocate (sums(0:b%tree%orientations), source=0.0_wp)
      do i = 1, size(b%list)
         do m1 = b%list(i)%first_loop, b%list(i)%last_loop
            associate (g => b%loops(m1), own => b%numbers%loops(m1))
               if (g%kind == loop_angles) cycle
               call add_terms(m, b, g%vector_loop, angle, sums)
               do k = g%first_vector, g%last_vector
                  d%length(k) = up(hypot(b%numbers%d(k)%x, b%numbers%d(k)%y))
                  d%weight(k) = up(terms_of(m1)*d%length(k) + sums(b%body_vectors(k)%orientation)/(length*own%unit))
               end do
               do k = g%first_slide, g%last_slide
                  d%slide_length(k) = up(length_of(b%numbers%e(k)))
                  d%slide_weight(k) = up((terms_of(m1) + of_vector + maxval(angle))*d%slide_length(k))
               end do
               d%ground_length(m1) = up(length_of(own%ground))
               d%ground_weight(m1) = up(terms_of(m1)*d%ground_length(m1) + sums(0)/(length*own%unit))
               d%direction_length(m1) = up(length_of(own%direction))
               d%direction_weight(m1) = up((2.0_wp*of_vector + maxval(angle))*d%direction_length(m1))
               sums = 0.0_wp
            end associate
         end do
         do k = b%list(i)%first_row, b%list(i)%last_row
            d%constant_weight(k) = up(2.0_wp*of_number*abs(b%numbers%rows(k)%constant))
            if (b%rows(k)%angular) d%constant_weight(k) = d%constant_weight(k) + 2.0_wp*maxval(angle)
         end do
      end do

   contains

      !> Of a vector and its share in the sum of loop `m1`.
      pure real(wp) function terms_of(m1)
         integer, intent(in) :: m1

         associate (g => b%loops(m1))
            terms_of = of_vector + of_row + rounding*(2 + g%last_vector - g%first_vector + g%last_slide - g%first_slide)
         end associate
      end function terms_of
   end function new_proof_data

   !> `x` rounded up.
   elemental real(wp) function up(x)
      real(wp), intent(in) :: x

      up = x*(1.0_wp + 16.0_wp*rounding)
   end function up

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
                  sums(o) = sums(o) + norm2(m%points(point)%offset)*(of_number + of_vector + count*rounding + angle(o))
                  if (m%links(m%points(point)%link)%ground) sums(o) = sums(o) + (of_number + count*rounding) &
                     *(norm2(m%links(m%points(point)%link)%position(:2)) + norm2(plane_origin(m)))
               else
                  o = t%orientation(m%points(m%pairs(pair)%point_i)%link)
                  sums(o) = sums(o) + abs(m%pairs(pair)%offset)*(of_number + of_vector + count*rounding + angle(o))
               end if
            end associate
         end do
      end associate
   end subroutine add_terms

   !> (0:2) By how much the splines of the tables of `law` and their derivatives can differ from the exact ones through
   !> these knots, in the drive's unit. With r what the equations of the second derivatives M leave, which are
   !> diagonally dominant, |dM| <= max |r_i|/(h_(i-1) + h_i).
   pure function table_errors(law) result(error)
      type(law_t), intent(in) :: law
      real(wp) :: error(0:2), of_m, r, h(2)
      integer :: i, k

      error = 0.0_wp
      do k = 1, size(law%splines)
         if (.not. allocated(law%splines(k)%x)) cycle
         associate (x => law%splines(k)%x, y => law%splines(k)%y, m => law%splines(k)%m)
            of_m = 0.0_wp
            do i = 2, size(x) - 1
               h = [x(i) - x(i - 1), x(i + 1) - x(i)]
               r = abs(h(1)*m(i - 1) + 2.0_wp*(h(1) + h(2))*m(i) + h(2)*m(i + 1) &
                  - 6.0_wp*((y(i + 1) - y(i))/h(2) - (y(i) - y(i - 1))/h(1))) &
                  + 16.0_wp*rounding*(1.0_wp + maxval(abs(x(i - 1:i + 1)))/minval(h)) &
                  *(2.0_wp*sum(h)*maxval(abs(m(i - 1:i + 1))) + 24.0_wp*maxval(abs(y(i - 1:i + 1)))/minval(h))
               of_m = max(of_m, r/sum(h))
            end do
            h(1) = maxval(x(2:) - x(:size(x) - 1))
            error = error + of_m*[h(1)**2, h(1), 1.0_wp]
         end associate
      end do
      error = up(error)
   end function table_errors
end module proof_data
