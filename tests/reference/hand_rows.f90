!> Tests. The rows of the tables from the places of the links, as jets in real128: a link's own, those of its points,
!> and of pairs the angle or the slide.
module hand_rows
   use mechanism, only: mechanism_t, request_t, request_link, request_point, request_pair, pair_prismatic
   use quad_jet, only: qp, jet_t, operator(+), operator(-), operator(*), sin, cos
   use closed_forms_dyads, only: body_t, place_t, place_on
   implicit none
   private
   public :: hand_row_t, row_by_hand, has_pairs, pair_slots

   !> Where the value, velocity and acceleration of slides stand, or those of angles where there are no slides; and where
   !> those of angles stand beside slides.
   integer, parameter :: pair_slots(0:2, 2) = reshape([1, 2, 4, 5, 6, 8], [3, 2])

   !> A row of the kind `kind` of a request; `column`: which of x, y, phi its values stand under, a slide under x and the
   !> angle of a pair under phi; `links`: those that it depends on.
   type :: hand_row_t
      integer :: kind = request_link
      character(8) :: name = ''
      integer :: columns = 3, column(3) = [1, 2, 3]
      integer :: slot(3, 0:2) = reshape([1, 2, 3, 4, 5, 6, 7, 8, 9], [3, 3])   !< of nine, from left to right
      integer :: links(2) = 0
      real(qp) :: value(3, 0:2) = 0.0_qp
   end type hand_row_t

contains

   !> The row that `request` asks for, of the links `b` in the order of the deck.
   function row_by_hand(m, b, request) result(row)
      type(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: b(:)
      type(request_t), intent(in) :: request
      type(hand_row_t) :: row
      type(place_t) :: p

      row%kind = request%kind
      associate (i => request%subject)
         select case (request%kind)
         case (request_link)
            row%name = m%links(i)%name
            row%links = i
            call take([b(i)%x, b(i)%y, b(i)%phi], row)
         case (request_point)
            row%name = m%points(i)%name
            row%links = m%points(i)%link
            p = point(m, b, i)
            call take([p%x, p%y], row)
         case default
            row%name = m%pairs(i)%name
            row%links = m%points([m%pairs(i)%point_i, m%pairs(i)%point_j])%link
            row%slot(1, :) = pair_slots(:, 1)
            if (m%pairs(i)%kind /= pair_prismatic) then
               row%column(1) = 3
               if (has_pairs(m, .true.)) row%slot(1, :) = pair_slots(:, 2)
            end if
            call take([pair_value(m, b, i)], row)
         end select
      end associate
   end function row_by_hand

   !> Pairs with a slide (`sliding`) or with an angle are asked for.
   logical function has_pairs(m, sliding)
      type(mechanism_t), intent(in) :: m
      logical, intent(in) :: sliding
      integer :: i

      has_pairs = .false.
      do i = 1, size(m%requests)
         if (m%requests(i)%kind /= request_pair) cycle
         if ((m%pairs(m%requests(i)%subject)%kind == pair_prismatic) .eqv. sliding) has_pairs = .true.
      end do
   end function has_pairs

   subroutine take(value, row)
      type(jet_t), intent(in) :: value(:)
      type(hand_row_t), intent(inout) :: row

      row%columns = size(value)
      row%value(:size(value), 0) = value%v
      row%value(:size(value), 1) = value%d
      row%value(:size(value), 2) = value%dd
   end subroutine take

   !> Point number `i` of the plane.
   type(place_t) function point(m, b, i)
      type(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: b(:)
      integer, intent(in) :: i

      point = place_on(b(m%points(i)%link), real(m%points(i)%offset(1), qp), real(m%points(i)%offset(2), qp))
   end function point

   !> The angle of pair number `i`, or how far its second point is along its guide.
   type(jet_t) function pair_value(m, b, i) result(value)
      type(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: b(:)
      integer, intent(in) :: i
      type(place_t) :: p, q
      type(jet_t) :: guide

      associate (pair => m%pairs(i))
         associate (first => b(m%points(pair%point_i)%link), second => b(m%points(pair%point_j)%link))
            value = second%phi - first%phi
            if (pair%kind /= pair_prismatic) return
            p = point(m, b, pair%point_i)
            q = point(m, b, pair%point_j)
            guide = first%phi + real(pair%alpha, qp)
            value = (q%x - p%x)*cos(guide) + (q%y - p%y)*sin(guide)
         end associate
      end associate
   end function pair_value
end module hand_rows
