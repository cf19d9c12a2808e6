!> What roundings change of a motion is added up of: the vectors of each vector loop and of each link of the chain, one
!> for each orientation that turns some, and what the roundings of the cards change of it.
module rounding_parts
   use kinds, only: wp
   use planar, only: vector_t, xy
   use mechanism, only: mechanism_t
   use blocks, only: blocks_t, block_t, body_vector_t, loop_components
   use block_state, only: unknown_t
   use block_engine, only: block_engine_t
   use card_roundings, only: directions, roundings, largest_part, own_in_tables, card_sizes, card_change
   implicit none
   private
   public :: part_t, arm_t, rounding_parts_t, gather_rounding_parts, is_plain_dyad, dyad_jacobian

   !> What a rounding of the calculation adds to both components of a vector, over its size: at most the root of two.
   real(wp), parameter, public :: own_part = 1.5_wp*largest_part*own_in_tables*epsilon(1.0_wp)

   !> What turns with one orientation, in its axes: a vector, and the `change` of the numbers it is the sum of in each
   !> of the directions, of all together as they stand there; the sum of the sizes of these. `off`: no direction changes
   !> it by more over `roundings`, with what is rounded there.
   type :: part_t
      integer :: orientation = 0
      real(wp) :: vector(2) = 0.0_wp, length = 0.0_wp
      real(wp) :: change(directions, 2) = 0.0_wp
      real(wp) :: size_of = 0.0_wp, off = 0.0_wp
   end type part_t

   !> How a link of the chain hangs on its parent: what turns with the parent, and with itself; the unit of its slide.
   type :: arm_t
      type(part_t) :: parts(2)
      integer :: count = 0                       !< of these that matter
      real(wp) :: slide = 0.0_wp
   end type arm_t

   !> Of a mechanism, for any motion. Loops have lengths in their units, arms in the deck's.
   type :: rounding_parts_t
      type(part_t), allocatable :: parts(:)      !< of all loops; in each those that angles of its block turn last
      integer, allocatable :: first(:), first_own(:)   !< (loops + 1), (loops)
      logical, allocatable :: is_plain(:)        !< (loops) there are no slides, and no projection
      type(arm_t), allocatable :: arms(:)        !< (links of the chain)
   end type rounding_parts_t

contains

   !> `block` is one vector loop that two angles of its own close: its Jacobian is `dyad_jacobian`.
   pure logical function is_plain_dyad(p, blocks, block)
      type(rounding_parts_t), intent(in) :: p
      type(blocks_t), intent(in) :: blocks
      type(block_t), intent(in) :: block

      is_plain_dyad = block%shape%n == 2 .and. block%first_loop == block%last_loop
      if (is_plain_dyad) is_plain_dyad = p%is_plain(block%first_loop) .and. blocks%loops(block%first_loop)%row_y > 0
   end function is_plain_dyad

   !> The Jacobian `a` (4, by columns) of a dyad whose own body vectors are `vectors`, at the unknowns `s`: their
   !> quarter turns.
   pure subroutine dyad_jacobian(vectors, d_of, s, a)
      type(body_vector_t), intent(in) :: vectors(2)
      type(vector_t), intent(in) :: d_of(2)
      type(unknown_t), intent(in) :: s(0:*)
      real(wp), intent(inout) :: a(4)
      integer :: k

      do k = 1, 2
         associate (at => vectors(k)%at, d => d_of(k), f => s(vectors(k)%orientation))
            a(at(1)) = -(f%s*d%x + f%c*d%y)
            a(at(2)) = f%c*d%x - f%s*d%y
         end associate
      end do
   end subroutine dyad_jacobian

   !> The parts `p` of the mechanism `m`, which `e` solves; `angle` (links): see `card_sizes`.
   subroutine gather_rounding_parts(p, m, e, angle)
      type(rounding_parts_t), intent(out) :: p
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      real(wp), intent(in) :: angle(:)
      real(wp), allocatable :: sizes(:)
      integer :: i, last

      sizes = card_sizes(m, angle)
      last = size(e%blocks%body_vectors)
      do i = 1, size(e%blocks%loops)
         associate (k => e%blocks%loops(i)%vector_loop)
            associate (first_term => e%blocks%equations%vector_loops%first_term)
               if (k > 0) last = last + first_term(k + 1) - first_term(k)
            end associate
         end associate
      end do
      associate (loops => size(e%blocks%loops))
         allocate (p%parts(last), p%first(loops + 1), p%first_own(loops), p%is_plain(loops))
         last = 0
         do i = 1, loops
            p%first(i) = last + 1
            call gather_loop(p, m, e, sizes, i, last)
         end do
         p%first(loops + 1) = last + 1
      end associate
      allocate (p%arms(size(e%chain%links)))
      do i = 1, size(p%arms)
         call gather_arm(p%arms(i), m, e, sizes, i)
      end do
   end subroutine gather_rounding_parts

   !> The parts of loop number `i`, behind part number `last`: of cards that turn with no body vector, and of the body
   !> vectors in their order.
   subroutine gather_loop(p, m, e, sizes, i, last)
      type(rounding_parts_t), intent(inout) :: p
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      real(wp), intent(in) :: sizes(:)
      integer, intent(in) :: i
      integer, intent(inout) :: last
      integer :: first, k

      associate (loop => e%blocks%loops(i), vectors => e%blocks%body_vectors)
         first = last + 1
         if (loop%vector_loop > 0) then
            associate (p => e%blocks%equations%vector_loops)
               do k = p%first_term(loop%vector_loop), p%first_term(loop%vector_loop + 1) - 1
                  call add_term(p%terms(:, k))
               end do
            end associate
         end if
         do k = loop%first_vector, loop%last_vector
            call move_to_end(part_of(vectors(k)%orientation))
            p%parts(last)%vector = xy(e%blocks%numbers%d(k))
         end do
         p%first_own(i) = last - (loop%last_vector - loop%first_own)
         do k = first, last
            call measure(p%parts(k), 1.0_wp/(e%length*e%blocks%numbers%loops(i)%unit))
         end do
         p%is_plain(i) = loop%kind == loop_components .and. loop%last_slide < loop%first_slide
      end associate

   contains

      !> Adds the point or the offset of a pair of `term` (2) to the part that turns as it does.
      subroutine add_term(term)
         integer, intent(in) :: term(2)
         real(wp) :: change(directions, 2)
         integer :: card, point

         card = abs(term(1))
         point = card
         if (card == 0) then
            card = size(m%points) + abs(term(2))
            point = m%pairs(abs(term(2)))%point_i
         end if
         change = card_change(m, sizes, card)
         ! Zeros are exact.
         if (.not. max(sizes(card), maxval(abs(change))) > 0.0_wp) return
         call add_card(p%parts(part_of(e%orientation_of(m%points(point)%link))), change, sizes(card), &
            sign(1, sum(term)))
      end subroutine add_term

      !> The number of the part that turns with `orientation`: a new one, where there is none yet.
      integer function part_of(orientation)
         integer, intent(in) :: orientation

         do part_of = first, last
            if (p%parts(part_of)%orientation == orientation) return
         end do
         last = part_of
         p%parts(last)%orientation = orientation
      end function part_of

      !> Part number `k` becomes the last.
      subroutine move_to_end(k)
         integer, intent(in) :: k
         type(part_t) :: part

         part = p%parts(k)
         p%parts(k:last - 1) = p%parts(k + 1:last)
         p%parts(last) = part
      end subroutine move_to_end
   end subroutine gather_loop

   !> How link number `i` of the chain hangs on its parent: see `link_motion`. Where both turn with one orientation
   !> there is one part; a part of which there is nothing is left out.
   subroutine gather_arm(arm, m, e, sizes, i)
      type(arm_t), intent(inout) :: arm
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      real(wp), intent(in) :: sizes(:)
      integer, intent(in) :: i
      type(part_t) :: parts(2)
      integer :: own, of_own, k
      logical :: is_i

      associate (h => e%chain%links(i))
         if (h%root > 0) return
         of_own = merge(1, 2, h%orientation == h%parent_orientation)
         parts%orientation = [h%parent_orientation, h%orientation]
         parts(1)%vector = h%place%reach
         parts(of_own)%vector = parts(of_own)%vector - h%place%body_vector
         associate (pair => m%pairs(h%pair))
            is_i = m%points(pair%point_i)%link == h%link
            own = merge(pair%point_i, pair%point_j, is_i)
            call take(1, pair%point_i + pair%point_j - own, 1)
            call take(of_own, own, -1)
         end associate
         if (h%slide > 0) call take(1, size(m%points) + h%pair, merge(1, -1, is_i))
         if (h%slide > 0) arm%slide = e%length*norm2(h%place%slide_body_vector)
      end associate
      do k = 1, 2
         call measure(parts(k), 1.0_wp)
         if (.not. max(parts(k)%length, parts(k)%off) > 0.0_wp) cycle
         arm%count = arm%count + 1
         arm%parts(arm%count) = parts(k)
      end do

   contains

      !> Adds number `card`, with its sign, to part number `k`.
      subroutine take(k, card, sign_of)
         integer, intent(in) :: k, card, sign_of

         call add_card(parts(k), card_change(m, sizes, card), sizes(card), sign_of)
      end subroutine take
   end subroutine gather_arm

   !> Adds a card's `change` (directions, 2) and size to `part`, with its sign `sign_of`.
   pure subroutine add_card(part, change, size_of, sign_of)
      type(part_t), intent(inout) :: part
      real(wp), intent(in) :: change(directions, 2), size_of
      integer, intent(in) :: sign_of

      part%change = part%change + sign_of*change
      part%size_of = part%size_of + size_of
   end subroutine add_card

   !> Of `part`, whose cards have the unit `scale`, the measures.
   pure subroutine measure(part, scale)
      type(part_t), intent(inout) :: part
      real(wp), intent(in) :: scale

      part%change = scale*part%change
      part%size_of = scale*part%size_of
      part%length = norm2(part%vector)
      part%off = sqrt(maxval(part%change(:, 1)**2 + part%change(:, 2)**2))/roundings + own_part*part%size_of
   end subroutine measure
end module rounding_parts
